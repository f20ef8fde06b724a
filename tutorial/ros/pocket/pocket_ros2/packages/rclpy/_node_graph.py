"""A node's view of the node graph."""

import re
from collections.abc import Callable
from typing import TypeVar

from rclpy._graph import Graph
from rclpy._middleware import TransportError
from rclpy._node_names import NodeNames
from rclpy._rclpy_pybind11 import NodeNameNonExistentError, RCLError
from rclpy._transport import PUBLISHERS, SUBSCRIPTIONS, EndpointInfo, NodeInfo
from rclpy.context import Context
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rclpy.topic_endpoint_info import TopicEndpointTypeEnum as Kind
from rclpy.type_hash import TypeHash

Answer = TypeVar("Answer")


class NodeGraph(NodeNames):
    """The part of a node that queries the node graph. Its methods raise InvalidHandle once the node is destroyed."""

    _context: Context

    def get_node_names(self) -> list[str]:
        """Return the names of all nodes in all processes; a name that two nodes share appears twice."""
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return the (name, namespace) of every node in every process."""
        return [(node.node_name, node.node_namespace) for node in self._ask(Graph.nodes)]

    def get_topic_names_and_types(self, no_demangle: bool = False) -> list[tuple[str, list[str]]]:
        """Return (topic, types) for each topic, sorted by name.

        Args:
            no_demangle: list all DDS topics, with their names on the wire.
        """
        return _by_topic([*self._endpoints(PUBLISHERS), *self._endpoints(SUBSCRIPTIONS)], no_demangle)

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> list[tuple[str, list[str]]]:
        """Return (topic, types) for a node's publishers; raise NodeNameNonExistentError for an unknown node."""
        return self._topics_of((node_name, node_namespace), PUBLISHERS, no_demangle)

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> list[tuple[str, list[str]]]:
        """Return (topic, types) for a node's subscriptions; see :meth:`get_publisher_names_and_types_by_node`."""
        return self._topics_of((node_name, node_namespace), SUBSCRIPTIONS, no_demangle)

    def count_publishers(self, topic_name: str) -> int:
        """Return the number of publishers on a topic in all processes; ``topic_name`` is not remapped."""
        return len(self._endpoints(PUBLISHERS, f"rt{self._expanded(topic_name)}"))

    def count_subscribers(self, topic_name: str) -> int:
        """Return the number of subscriptions on a topic in all processes; ``topic_name`` is not remapped."""
        return len(self._endpoints(SUBSCRIPTIONS, f"rt{self._expanded(topic_name)}"))

    def get_publishers_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        """Return information about each publisher on a topic.

        Args:
            topic_name: the topic's name, which this method remaps unless ``no_mangle`` is true.
            no_mangle: whether ``topic_name`` is the topic's name in DDS.
        """
        return self._infos(PUBLISHERS, topic_name, no_mangle)

    def get_subscriptions_info_by_topic(self, topic_name: str, no_mangle: bool = False) -> list[TopicEndpointInfo]:
        """Return information about each subscription on a topic; see :meth:`get_publishers_info_by_topic`."""
        return self._infos(SUBSCRIPTIONS, topic_name, no_mangle)

    def _endpoints(self, kind: Kind, wire_topic: str | None = None) -> list[EndpointInfo]:
        return self._ask(lambda graph: graph.participant.endpoints(kind, wire_topic))

    def _ask(self, question: Callable[[Graph], Answer]) -> Answer:
        self._require_handle()
        try:
            return question(self._context.graph)
        except TransportError as error:  # the context is shutting down
            raise RCLError(f"failed to query the node graph: {error}") from None

    def _topics_of(self, who: tuple[str, str], kind: Kind, no_demangle: bool) -> list[tuple[str, list[str]]]:
        if who not in self.get_node_names_and_namespaces():
            raise NodeNameNonExistentError(f"cannot get names and types: there is no node {who[0]!r} in {who[1]!r}")
        owners = self._ask(Graph.owners)
        own = {gid for gid, node in owners.items() if (node.node_name, node.node_namespace) == who}
        return _by_topic([endpoint for endpoint in self._endpoints(kind) if endpoint.guid in own], no_demangle)

    def _infos(self, kind: Kind, topic_name: str, no_mangle: bool) -> list[TopicEndpointInfo]:
        wire_topic = topic_name if no_mangle else f"rt{self._remapped(self._expanded(topic_name))}"
        endpoints = self._ask(lambda graph: graph.participant.endpoints(kind, wire_topic, full=True))
        owners = self._ask(Graph.owners) if endpoints else {}
        return [_info(endpoint, owners.get(endpoint.guid)) for endpoint in endpoints]


def _info(endpoint: EndpointInfo, owner: NodeInfo | None) -> TopicEndpointInfo:
    version, _, value = endpoint.type_hash.removeprefix("RIHS").partition("_")
    return TopicEndpointInfo(
        node_name=owner.node_name if owner else "_NODE_NAME_UNKNOWN_",
        node_namespace=owner.node_namespace if owner else "_NODE_NAMESPACE_UNKNOWN_",
        topic_type=_type_name(endpoint),
        topic_type_hash=TypeHash(int(version), bytes.fromhex(value)) if version else TypeHash(),
        endpoint_type=endpoint.kind,
        endpoint_gid=list(endpoint.guid),
        qos_profile=endpoint.qos,
    )


def _by_topic(endpoints: list[EndpointInfo], no_demangle: bool) -> list[tuple[str, list[str]]]:
    topics: dict[str, set[str]] = {}
    for endpoint in endpoints:
        if no_demangle:
            topics.setdefault(endpoint.topic_name, set()).add(endpoint.type_name)
        elif endpoint.topic_name.startswith("rt/"):
            topics.setdefault(endpoint.topic_name[2:], set()).add(_type_name(endpoint))
    return [(topic, sorted(types)) for topic, types in sorted(topics.items())]


def _type_name(endpoint: EndpointInfo) -> str:
    """Return a type's name in ROS 2: ``"sensor_msgs/msg/Joy"`` for ``"sensor_msgs::msg::dds_::Joy_"``."""
    return re.sub(r"dds_::(.*)_$", r"\1", endpoint.type_name).replace("::", "/")
