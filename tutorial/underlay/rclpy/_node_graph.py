"""What a node tells about itself and asks about the others."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from cyclonedds.qos import Policy
from rclpy._dds_qos import from_dds
from rclpy._graph import gids_of
from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum

if TYPE_CHECKING:
    from rclpy._graph import Endpoint
    from rclpy.context import Context

__all__ = ["NodeGraph"]


class NodeGraph:
    """The part of a node that deals with the node graph."""

    _context: Context

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return a topic's full name."""
        raise NotImplementedError

    def get_node_names(self) -> list[str]:
        """Return the names of all nodes there are, in all processes; a name taken twice appears twice."""
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return (name, namespace) of all nodes there are, in all processes."""
        return [(node.node_name, node.node_namespace) for node in self._context.graph.nodes()]

    def get_topic_names_and_types(self, no_demangle: bool = False) -> list[tuple[str, list[str]]]:
        """Return (topic, types) of all topics there are, sorted by name.

        Args:
            no_demangle: list all DDS topics, with the names that they have on the wire.
        """
        graph = self._context.graph
        return _by_topic([*graph.publishers(), *graph.subscriptions()], no_demangle)

    def get_publisher_names_and_types_by_node(self, node_name: str, node_namespace: str) -> list[tuple[str, list[str]]]:
        """Return (topic, types) of all that a node publishes."""
        return self._topics_of(node_name, node_namespace, self._context.graph.publishers())

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str
    ) -> list[tuple[str, list[str]]]:
        """Return (topic, types) of all that a node subscribes to."""
        return self._topics_of(node_name, node_namespace, self._context.graph.subscriptions())

    def count_publishers(self, topic_name: str) -> int:
        """Return the number of publishers on a topic, in all processes."""
        return len(self._context.graph.publishers(self._wire_topic(topic_name)))

    def count_subscribers(self, topic_name: str) -> int:
        """Return the number of subscriptions on a topic, in all processes."""
        return len(self._context.graph.subscriptions(self._wire_topic(topic_name)))

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        """Return what is known about each publisher on a topic."""
        endpoints = self._context.graph.publishers(self._wire_topic(topic_name, no_mangle))
        return [self._info(endpoint, TopicEndpointTypeEnum.PUBLISHER) for endpoint in endpoints]

    def get_subscriptions_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        """Return what is known about each subscription on a topic."""
        endpoints = self._context.graph.subscriptions(self._wire_topic(topic_name, no_mangle))
        return [self._info(endpoint, TopicEndpointTypeEnum.SUBSCRIPTION) for endpoint in endpoints]

    def _wire_topic(self, topic_name: str, no_mangle: bool = False) -> str:
        return topic_name if no_mangle else f"rt{self.resolve_topic_name(topic_name)}"

    def _topics_of(self, name: str, namespace: str, endpoints: list[Endpoint]) -> list[tuple[str, list[str]]]:
        nodes = self._context.graph.nodes()
        same = (node for node in nodes if (node.node_name, node.node_namespace) == (name, namespace))
        gids = {gid for node in same for gid in gids_of(node)}
        return _by_topic([endpoint for endpoint in endpoints if endpoint.key.bytes in gids])

    def _info(self, endpoint: Endpoint, kind: TopicEndpointTypeEnum) -> TopicEndpointInfo:
        owner = self._context.graph.owner(endpoint)
        return TopicEndpointInfo(
            node_name=owner.node_name if owner else "_NODE_NAME_UNKNOWN_",
            node_namespace=owner.node_namespace if owner else "_NODE_NAMESPACE_UNKNOWN_",
            topic_type=_type_name(endpoint.type_name),
            topic_type_hash=_type_hash(endpoint),
            endpoint_type=kind,
            endpoint_gid=list(endpoint.key.bytes),
            qos_profile=from_dds(endpoint.qos),
        )


def _by_topic(endpoints: list[Endpoint], no_demangle: bool = False) -> list[tuple[str, list[str]]]:
    topics: dict[str, set[str]] = {}
    for endpoint in endpoints:
        if no_demangle:
            topics.setdefault(endpoint.topic_name, set()).add(endpoint.type_name)
        elif endpoint.topic_name.startswith("rt/"):
            topics.setdefault(endpoint.topic_name[2:], set()).add(_type_name(endpoint.type_name))
    return [(topic, sorted(types)) for topic, types in sorted(topics.items())]


def _type_name(wire_name: str) -> str:
    """Return a type's name in ROS 2: ``"sensor_msgs/msg/Joy"`` for ``"sensor_msgs::msg::dds_::Joy_"``."""
    return re.sub(r"dds_::(.*)_$", r"\1", wire_name).replace("::", "/")


def _type_hash(endpoint: Endpoint) -> str:
    userdata = endpoint.qos[Policy.Userdata].data if Policy.Userdata in endpoint.qos else b""
    found = re.search(rb"typehash=([^;]*);", userdata)
    return found[1].decode() if found else "INVALID"
