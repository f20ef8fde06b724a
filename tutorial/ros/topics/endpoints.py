"""Who is on a topic, whatever it is called, and what a subscription can ask of all publishers there."""

from collections.abc import Callable

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from tutorial.ros.topics.names import is_valid_topic

SENSOR_DEPTH = 5  # of rclpy's qos_profile_sensor_data, which ros2 begins with


def publishers_on(node: Node, topic: str) -> list[TopicEndpointInfo]:
    """Return what is known of each publisher on a topic.

    Args:
        node: that asks.
        topic: its full name, as `Node.get_topic_names_and_types` has it.
    """
    return _infos(node.get_publishers_info_by_topic, topic)


def subscriptions_on(node: Node, topic: str) -> list[TopicEndpointInfo]:
    """Return what is known of each subscription on a topic, as `publishers_on`."""
    return _infos(node.get_subscriptions_info_by_topic, topic)


def _infos(ask: Callable[..., list[TopicEndpointInfo]], topic: str) -> list[TopicEndpointInfo]:
    """Ask by the topic's name; rclpy refuses one that breaks the rules, but takes the name that it has in DDS."""
    return ask(topic) if is_valid_topic(topic) else ask(f"rt{topic}", no_mangle=True)


def reader_qos(node: Node, topic: str) -> QoSProfile:
    """Choose what a subscription can ask for so that all publishers of a topic fit it, as ``ros2`` does.

    Args:
        node: that asks.
        topic: its full name.
    """
    offered = [info.qos_profile for info in publishers_on(node, topic)]
    reliable = bool(offered) and all(qos.reliability == ReliabilityPolicy.RELIABLE for qos in offered)
    lasting = bool(offered) and all(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in offered)
    return QoSProfile(
        depth=SENSOR_DEPTH,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if lasting else DurabilityPolicy.VOLATILE,
    )
