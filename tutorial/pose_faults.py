"""Finds poses and joint states that a viewer cannot show, and counts the messages that the viewer skips."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from sensor_msgs.msg import JointState

if TYPE_CHECKING:
    from geometry_msgs.msg import TransformStamped
    from rclpy.node import Node

LARGEST = 100_000  # maximum total of numbers and characters in a joint state message: more than any robot needs
FARTHEST = 1e9  # [m]; views use single precision, which can represent even the square of this
TOLERANCE = 0.01  # tolerance for a unit quaternion's squared length
QUIET = 50  # messages skipped silently at the start, while only one topic's publisher has been discovered


def fault_of(message: JointState | TransformStamped) -> str:
    """Return why a viewer in the frame ``odom`` cannot show a message, or an empty string if it can."""
    if isinstance(message, JointState):
        arrays = message.header.frame_id, message.name, message.position, message.velocity, message.effort
        return "with more joints than any robot has" if sum(map(len, (*arrays, *message.name))) > LARGEST else ""
    p, q = message.transform.translation, message.transform.rotation
    if message.header.frame_id != "odom":
        return "with a parent frame other than odom"
    if not all(abs(each) <= FARTHEST for each in (p.x, p.y, p.z)):  # also False for NaN
        return "with a position that is not finite, or too far away"
    if not abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) <= TOLERANCE:
        return "with an orientation that is not a unit quaternion"
    return ""


class Tally:
    """Counts the messages that a viewer shows and those that it skips.

    Logs how many messages were skipped, at most once every five seconds, but not during startup.

    Args:
        name: the body's name.
        node: the node that logs.

    Attributes:
        shown: how many pairs of a pose and a joint state the viewer has shown.
        left_out: the number of messages skipped, by reason.
    """

    def __init__(self, name: str, node: Node) -> None:
        self._name, self._logger = name, node.get_logger()
        self.shown = 0
        self.left_out = Counter[str]()

    def leave_out(self, why: str) -> None:
        """Count a message that the viewer does not show."""
        self.left_out[why] += 1
        if self.shown or self.left_out[why] > QUIET:
            counts = ", ".join(f"{count} {why}" for why, count in self.left_out.items())
            self._logger.warning(f"{self._name}: messages not shown so far: {counts}", throttle_duration_sec=5.0)
