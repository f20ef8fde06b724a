"""Information about a publisher or subscription on a topic."""

from dataclasses import dataclass
from enum import IntEnum

from rclpy.qos import QoSProfile
from rclpy.type_hash import TypeHash


class TopicEndpointTypeEnum(IntEnum):
    """The kind of endpoint."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


@dataclass
class TopicEndpointInfo:
    """A publisher or subscription, and its node.

    Attributes:
        topic_type: the message type, such as ``"sensor_msgs/msg/Joy"``.
        endpoint_gid: the 16 bytes that identify the endpoint.
        qos_profile: the QoS that the endpoint offers or requests.
    """

    node_name: str
    node_namespace: str
    topic_type: str
    topic_type_hash: TypeHash
    endpoint_type: TopicEndpointTypeEnum
    endpoint_gid: list[int]
    qos_profile: QoSProfile
