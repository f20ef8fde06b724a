"""Who is on a topic, whatever it is called."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from tutorial.ros.topics.names import is_valid_topic

__all__ = ["publishers_on", "subscriptions_on"]


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
