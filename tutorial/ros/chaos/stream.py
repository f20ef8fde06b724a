"""Publish joint states with faults."""

import math
from collections.abc import Sequence
from typing import Any

from rclpy.node import Node
from sensor_msgs.msg import JointState

from tutorial.errors import TutorialError
from tutorial.ros.chaos.faults import Chaos, set_stamp_ns

JOINTS = ("TURRET_Y", "TURRET_P")
RATE = 50  # [Hz]
TOPIC = "/Tank/joint_state"
DEPTH = 100  # enough for a burst


def swing(number: int, joints: Sequence[str] = JOINTS, rate: float = RATE) -> JointState:
    """Return a good message: all joints swing steadily between 0.15 and 0.65 rad, each more slowly than the one before.

    Args:
        number: the message's number, starting at 0; it determines the content.
        joints: names of the joints.
        rate: the message rate to assume [Hz].
    """
    message = JointState(name=list(joints))
    set_stamp_ns(message, round(number * 1e9 / rate))
    omegas = [2 * math.pi / (4 + 2 * i) for i in range(len(joints))]  # [rad/s]
    seconds = number / rate
    message.position = [0.4 + 0.25 * math.sin(omega * seconds) for omega in omegas]
    message.velocity = [0.25 * omega * math.cos(omega * seconds) for omega in omegas]
    message.effort = [0.0] * len(joints)
    return message


class ChaosStream:
    """Injects faults into a good stream of joint states and publishes the result, on the thread that spins the node.

    Args:
        node: the node that publishes.
        chaos: injects the faults into messages.
        good: the topic of the good stream; None to use `swing` instead.

    Attributes:
        chaos: the given `Chaos`.

    Raises:
        TutorialError: the good stream is on the same topic as the faulty one.
    """

    def __init__(self, node: Node, chaos: Chaos, good: str | None = None) -> None:
        self.chaos = chaos
        self._node: Any = node
        self._number = 0
        self._publishers: dict[str, Any] = {"publish": node.create_publisher(JointState, TOPIC, DEPTH)}
        if good is None:
            node.create_timer(1 / RATE, self._swing)
            return
        subscription = node.create_subscription(JointState, good, self._send, DEPTH)
        if subscription.topic_name == self._publishers["publish"].topic_name:
            raise TutorialError(
                f"the good stream and the faulty stream are both on {subscription.topic_name!r}. Start the good "
                f"stream's publisher with --ros-args -r {TOPIC}:=/good, and read its messages with --from /good."
            )

    def _swing(self) -> None:
        self._send(swing(self._number))
        self._number += 1

    def _send(self, message: JointState) -> None:
        """Inject faults into a message, and publish the result."""
        for action in self.chaos.apply(message):
            kind = "second" if action.kind == "second" else "publish"
            if action.kind == "restart":
                self._node.destroy_publisher(self._publishers.pop(kind))
            if kind not in self._publishers:
                self._publishers[kind] = self._node.create_publisher(JointState, TOPIC, DEPTH)
            if action.message is not None:
                self._publishers[kind].publish(action.message)
