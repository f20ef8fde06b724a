"""What is known about a publisher or subscription on a topic."""

from dataclasses import dataclass
from enum import IntEnum

from rclpy.qos import QoSProfile
from rclpy.type_hash import TypeHash


class TopicEndpointTypeEnum(IntEnum):
    """Which of the two it is."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


@dataclass
class TopicEndpointInfo:
    """A publisher or subscription, with the node it belongs to.

    Attributes:
        topic_type: such as ``"sensor_msgs/msg/Joy"``.
        endpoint_gid: the 16 bytes that tell it from all others.
        qos_profile: what it offers or asks for.
    """

    node_name: str
    node_namespace: str
    topic_type: str
    topic_type_hash: TypeHash
    endpoint_type: TopicEndpointTypeEnum
    endpoint_gid: list[int]
    qos_profile: QoSProfile
