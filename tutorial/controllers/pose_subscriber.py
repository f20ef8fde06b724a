"""Step 7: show where another program's robot is, and its joints, both of the same moment."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import JointMatcher

MOST = 10_000  # joints, or transforms, of a message; no robot has so many
LONGEST = 1_000_000  # characters of a message's names
MOST_WAITING = 50  # messages of a topic: a second of them
FARTHEST = 1e9  # [m] single precision, with which views draw, still holds its square
TOLERANCE = 0.01  # by which a quaternion's squared length may differ from 1
ALONE, REPEATED = "without a partner of the same stamp", "of a stamp that was there"


class PoseSubscriber(SimpleController):
    """Show the pose and the joint states that another program publishes: both of one stamp together, or neither."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Subscribe to the body's joint states, and to the transforms of all robots."""
        self.node, self.call_later = config.node, config.call_later
        self.frame = f"{config.body.name}/base_link"
        self.display = PoseDisplay(config, lambda: self.joint_states.get_publisher_count())  # before messages come
        topic = f"{config.body.name}/joint_state"
        self.joint_states = self.node.create_subscription(JointState, topic, self.on_joint_state, 10)
        self.transforms = self.node.create_subscription(TFMessage, "/tf", self.on_tf, 100)

    def on_joint_state(self, message: JointState) -> None:  # executor's thread: post and return
        """Hand the message to the main thread."""
        self.call_later(self.display.take, "joints", message)

    def on_tf(self, message: TFMessage) -> None:  # executor's thread
        """Hand the transform of this body to the main thread, and leave out the others'."""
        own = [each for each in message.transforms[:MOST] if each.child_frame_id == self.frame]
        for transform in own[:1]:
            self.call_later(self.display.take, "pose", transform)

    def unconfigure(self) -> None:  # main thread
        """Stop listening."""
        self.node.destroy_subscription(self.joint_states)
        self.node.destroy_subscription(self.transforms)


class StampPairs:
    """Finds the messages of two streams that have the same stamp, much like `message_filters.TimeSynchronizer`.

    A message waits for its partner. Both streams are in order, so a message that came before a pair gets no partner
    any more. If too many wait, the one that came first goes, whatever its stamp: a publisher may start again, from 0.

    Args:
        leave_out: called with the reason for each message that gets no partner.
    """

    def __init__(self, leave_out: Callable[[str], object]) -> None:
        self.leave_out = leave_out
        self.waiting: dict[tuple[int, int], dict[str, Any]] = {}  # by stamp, in the order of arrival; then by stream
        self.newest: tuple[int, int] | None = None  # the stamp of the last pair

    def add(self, stream: str, message: Any) -> dict[str, Any] | None:
        """Take the next message of a stream. Return the pair that it completes, by stream; None if there is none."""
        stamp = message.header.stamp.sec, message.header.stamp.nanosec
        if stamp == self.newest:
            self.leave_out(REPEATED)
            return None
        if stream in self.waiting.get(stamp, ()):
            self.drop(stamp, REPEATED)
        self.waiting.setdefault(stamp, {})[stream] = message
        complete = len(self.waiting[stamp]) == 2
        while (first := next(iter(self.waiting))) != stamp and (complete or len(self.waiting) > MOST_WAITING):
            self.drop(first, ALONE)
        self.newest = stamp if complete else self.newest
        return self.waiting.pop(stamp) if complete else None

    def drop(self, stamp: tuple[int, int], why: str) -> None:
        """Drop the waiting message of a stamp."""
        del self.waiting[stamp]
        self.leave_out(why)


class PoseDisplay:
    """Shows a body's pose and its joints. Main thread only.

    Args:
        config: with the displayed body.
        publishers: returns the number of publishers of the joint states.
    """

    def __init__(self, config: ControllerConfig, publishers: Callable[[], int]) -> None:
        self.body, self.tally = config.body, Tally(config)
        self.matcher = JointMatcher(self.body.joint_ranges, publishers)
        self.pairs = StampPairs(self.tally.leave_out)

    def take(self, stream: str, message: JointState | TransformStamped) -> None:
        """Show the message and its partner, if that has come; otherwise keep the message."""
        if fault := fault_of(message):
            self.tally.leave_out(fault)
        elif pair := self.pairs.add(stream, message):
            self.show(**pair)

    def show(self, joints: JointState, pose: TransformStamped) -> None:
        """Set the pose and the joints of one moment in one go. A late message moves neither."""
        positions, report = self.matcher.match(joints)
        if not report.dropped:
            p, q = pose.transform.translation, pose.transform.rotation
            self.body.position = p.x, p.y, p.z
            self.body.orientation_wxyz = q.w, q.x, q.y, q.z
            self.body.set_joint_positions(positions)
            self.body.calc_forward_kinematics()
            self.tally.shown += 1
        self.body.notify_change(report)


class Tally:
    """Counts what the viewer shows and leaves out. Logs it once in five seconds, but not at the very beginning.

    Attributes:
        shown: the number of pairs.
        left_out: the number of messages, by reason.
    """

    def __init__(self, config: ControllerConfig) -> None:
        self.name, self.logger = config.body.name, config.node.get_logger()
        self.shown = 0
        self.left_out = Counter[str]()

    def leave_out(self, why: str) -> None:
        """Count a message that the viewer does not show."""
        self.left_out[why] += 1
        if self.shown or self.left_out[why] > MOST_WAITING:
            counts = ", ".join(f"{count} {why}" for why, count in self.left_out.items())
            self.logger.warning(f"{self.name}: messages not shown so far: {counts}", throttle_duration_sec=5.0)


def fault_of(message: JointState | TransformStamped) -> str:
    """Return why the viewer cannot show a message; empty if it can."""
    if isinstance(message, JointState):
        too_many = max(map(len, (message.name, message.position, message.velocity, message.effort))) > MOST
        too_long = too_many or sum(map(len, (message.header.frame_id, *message.name))) > LONGEST
        return "with more joints than a robot has" if too_long else ""
    p, q = message.transform.translation, message.transform.rotation
    if message.header.frame_id != "odom":
        return "with another parent than odom"
    if not all(abs(each) <= FARTHEST for each in (p.x, p.y, p.z)):  # NaN is not, either
        return "with a place that is not finite, or too far away"
    if not abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) <= TOLERANCE:
        return "with a rotation that is no unit quaternion"
    return ""
