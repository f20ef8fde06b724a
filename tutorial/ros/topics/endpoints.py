"""Find a topic's publishers and subscriptions, even if its name is invalid, and a QoS that suits all its publishers."""

from collections.abc import Callable

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from tutorial.ros.topics.names import is_valid_topic

SENSOR_DEPTH = 5  # as in rclpy's qos_profile_sensor_data, which ros2 uses


def publishers_on(node: Node, topic: str) -> list[TopicEndpointInfo]:
    """Return rclpy's information about each publisher on a topic.

    Args:
        node: the node that queries the graph.
        topic: the topic's full name, as in `Node.get_topic_names_and_types`.
    """
    return _infos(node.get_publishers_info_by_topic, topic)


def subscriptions_on(node: Node, topic: str) -> list[TopicEndpointInfo]:
    """Return rclpy's information about each subscription on a topic; see `publishers_on`."""
    return _infos(node.get_subscriptions_info_by_topic, topic)


def _infos(ask: Callable[..., list[TopicEndpointInfo]], topic: str) -> list[TopicEndpointInfo]:
    """Query by the topic's name or, if rclpy would reject that name as invalid, by the topic's name in DDS."""
    return ask(topic) if is_valid_topic(topic) else ask(f"rt{topic}", no_mangle=True)


def reader_qos(node: Node, topic: str) -> QoSProfile:
    """Choose a subscription QoS that suits all publishers of a topic, as ``ros2`` does.

    Args:
        node: the node that queries the graph.
        topic: the topic's full name.
    """
    offered = [info.qos_profile for info in publishers_on(node, topic)]
    reliable = bool(offered) and all(qos.reliability == ReliabilityPolicy.RELIABLE for qos in offered)
    lasting = bool(offered) and all(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in offered)
    return QoSProfile(
        depth=SENSOR_DEPTH,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if lasting else DurabilityPolicy.VOLATILE,
    )
