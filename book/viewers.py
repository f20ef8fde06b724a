"""Small models of how this tutorial's viewer and other programs handle joint states, based on their source code.

A model stores a pose, receives one message after another, and returns whether the program reports a problem. The models
omit everything else, such as mimic joints.
"""

from collections.abc import Mapping
from math import isfinite
from typing import Any

from tutorial.joints import JointMatcher
from tutorial.ros.chaos.faults import SECOND_NS, stamp_ns


class Viewer:
    """A program that shows joint states.

    Args:
        ranges: the robot's joints, in the robot's order, and their ranges [rad].

    Attributes:
        pose: the displayed position of each joint [rad].
        ended: whether an error has ended the program.
    """

    name = ""
    ended = False

    def __init__(self, ranges: Mapping[str, tuple[float, float]]) -> None:
        self.pose = dict.fromkeys(ranges, 0.0)

    def take(self, message: Any, publisher: str = "publish") -> bool:
        """Show a message, and return whether the program reports a problem with it.

        Args:
            message: the `sensor_msgs/JointState`.
            publisher: its sender, ``"publish"`` or ``"second"``.
        """
        raise NotImplementedError


class TankTutorial(Viewer):
    """This tutorial's viewer.

    Source: `tutorial/joints.py`.
    """

    name = "this tutorial"

    def __init__(self, ranges: Mapping[str, tuple[float, float]]) -> None:
        super().__init__(ranges)
        self._publishers = {"publish"}  # the publishers in the node graph
        self._matcher = JointMatcher(ranges, lambda: len(self._publishers))

    def take(self, message: Any, publisher: str = "publish") -> bool:
        self._publishers.add(publisher)
        positions, report = self._matcher.match(message)
        self.pose.update(positions)
        return not report.clean


class ChoreonoidTutorial(Viewer):
    """The original tutorial's viewer: the i-th entry moves the i-th joint if their names are equal.

    Source: choreonoid/choreonoid_ros_tank_tutorial, `src/RttJointStateSubscriber.cpp`.
    """

    name = "the original"

    def take(self, message: Any, publisher: str = "publish") -> bool:
        for joint, name, position in zip(tuple(self.pose), message.name, message.position):
            if joint == name:
                self.pose[joint] = position
        return False


class RobotStatePublisher(Viewer):
    """robot_state_publisher at its default rate of 20 Hz, and tf2, which stores its transforms.

    robot_state_publisher drops messages whose lists of names and positions differ in length. It also drops a message if
    it has published every joint of the message within the last interval, as measured by the stamps. For a repeated
    name, it uses the first position, because it inserts the positions into a map. tf2 rejects NaN and shows the
    transform with the newest stamp.

    Source: ros/robot_state_publisher, `src/robot_state_publisher.cpp`; ros2/geometry2, `tf2/src/buffer_core.cpp`.
    """

    name = "robot_state_publisher"
    interval_ns = SECOND_NS // 20

    def __init__(self, ranges: Mapping[str, tuple[float, float]]) -> None:
        super().__init__(ranges)
        self._published_ns: dict[str, int] = {}
        self._shown_ns: dict[str, int] = {}

    def take(self, message: Any, publisher: str = "publish") -> bool:
        if len(message.name) != len(message.position):
            return True
        ns = stamp_ns(message)
        last = min((self._published_ns.get(name, 0) for name in message.name), default=0)
        if ns < last + self.interval_ns:
            return False
        self._published_ns |= dict.fromkeys(message.name, ns)
        positions = dict(reversed(list(zip(message.name, message.position))))
        complaints = [self._transform(joint, positions[joint], ns) for joint in self.pose if joint in positions]
        return any(complaints)

    def _transform(self, joint: str, position: float, ns: int) -> bool:
        """Store a transform as tf2 does, and return whether tf2 complains."""
        if not isfinite(position):  # the sine of an infinite angle is NaN
            return True
        if ns >= self._shown_ns.get(joint, 0):
            self._shown_ns[joint] = ns
            self.pose[joint] = position
        return False


class JointStatePublisher(Viewer):
    """joint_state_publisher with a source_list: for each joint's name, it uses the position at the same index.

    It ignores messages without positions. If a message has positions, but none at this index, the callback raises an
    error, which ends the program.

    Source: ros/joint_state_publisher, `joint_state_publisher/joint_state_publisher/joint_state_publisher.py`.
    """

    name = "joint_state_publisher"

    def take(self, message: Any, publisher: str = "publish") -> bool:
        for i, name in enumerate(message.name):
            if name in self.pose and len(message.position):
                if i >= len(message.position):
                    self.ended = True
                    return True
                self.pose[name] = message.position[i]
        return False


class Foxglove(Viewer):
    """The 3D panel of Foxglove Studio: it matches names and ignores stamps.

    It shows a joint at 0 if the message contains the joint's name, but no position for it.

    Source: foxglove/studio, `packages/studio-base/src/panels/ThreeDeeRender/renderables/Urdfs.ts`.
    """

    name = "Foxglove Studio"

    def take(self, message: Any, publisher: str = "publish") -> bool:
        for i, name in enumerate(message.name):
            if name in self.pose:
                self.pose[name] = message.position[i] if i < len(message.position) else 0.0
        return False


class PlotJuggler(Viewer):
    """PlotJuggler, with its newest points as the pose: it matches names and skips NaN, infinities and extra entries.

    By default, it uses a message's arrival time, not its stamp.

    Source: PlotJuggler/PlotJuggler, `plotjuggler_plugins/ParserROS/ros_parser.cpp` since pull request 927,
    `plotjuggler_base/include/PlotJuggler/plotdatabase.h`.
    """

    name = "PlotJuggler"

    def take(self, message: Any, publisher: str = "publish") -> bool:
        for name, position in zip(message.name, message.position):
            if name in self.pose and isfinite(position):
                self.pose[name] = position
        return False


VIEWERS = (TankTutorial, ChoreonoidTutorial, RobotStatePublisher, JointStatePublisher, Foxglove, PlotJuggler)
