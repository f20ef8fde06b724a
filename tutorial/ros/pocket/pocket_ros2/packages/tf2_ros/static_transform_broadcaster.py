"""Publish transforms that never change."""

from collections.abc import Iterable

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage
from tf2_ros.transform_broadcaster import as_list


class StaticTransformBroadcaster:
    """Publishes transforms on ``/tf_static``, where late-joining subscribers also receive them.

    Each message contains all transforms sent so far. As in tf2_ros 0.36.4, the first transform for a child frame is
    used, and later transforms for that frame are ignored.

    Args:
        node: the node that publishes.
        qos: quality of service, or the number of messages to keep; if None, keep the last message for late
            subscribers.
    """

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        if qos is None:
            qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", qos)
        self.net_message = TFMessage()

    def sendTransform(self, transform: TransformStamped | Iterable[TransformStamped]) -> None:  # noqa: N802
        """Add one or more transforms, and publish all transforms sent so far."""
        transforms = self.net_message.transforms
        for new in as_list(transform):
            if new.child_frame_id not in {known.child_frame_id for known in transforms}:
                transforms.append(new)
        self.pub_tf.publish(self.net_message)
