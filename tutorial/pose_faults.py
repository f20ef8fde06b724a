"""What a viewer of poses refuses to show, and a count of what it leaves out."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from sensor_msgs.msg import JointState

if TYPE_CHECKING:
    from geometry_msgs.msg import TransformStamped
    from rclpy.node import Node

LARGEST = 100_000  # numbers and characters of a message of joint states: no robot has so many
FARTHEST = 1e9  # [m] single precision, with which views draw, still holds its square
TOLERANCE = 0.01  # by which a quaternion's squared length may differ from 1
QUIET = 50  # messages left out before the first that is shown: the viewer hears one topic earlier than the other


def fault_of(message: JointState | TransformStamped) -> str:
    """Return why a viewer in the frame ``odom`` cannot show a message; empty if it can."""
    if isinstance(message, JointState):
        arrays = message.header.frame_id, message.name, message.position, message.velocity, message.effort
        return "with more joints than a robot has" if sum(map(len, (*arrays, *message.name))) > LARGEST else ""
    p, q = message.transform.translation, message.transform.rotation
    if message.header.frame_id != "odom":
        return "with another parent than odom"
    if not all(abs(each) <= FARTHEST for each in (p.x, p.y, p.z)):  # NaN is not, either
        return "with a place that is not finite, or too far away"
    if not abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) <= TOLERANCE:
        return "with a rotation that is no unit quaternion"
    return ""


class Tally:
    """Counts what a viewer shows and leaves out. Logs it once in five seconds, but not at the very beginning.

    Args:
        name: the body's.
        node: its logger is used.

    Attributes:
        shown: the number of pairs.
        left_out: the number of messages, by reason.
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
