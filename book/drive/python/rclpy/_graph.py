"""The node graph of the page's programs, as `cyclonedds.Wire` knows it. Replaces the pocket ROS 2's module."""

from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any

from cyclonedds import Entity, Participant

PUBLISHERS, SUBSCRIPTIONS = True, False
DiscoveredEndpoint = Node = Any


class Graph:
    """The node graph as seen from one participant."""

    def __init__(self, participant: Participant) -> None:
        self.participant, self.changes = participant, Entity(participant)

    def add_node(self, namespace: str, name: str) -> Node:
        """Announce a node of this program."""
        node = SimpleNamespace(node_namespace=namespace, node_name=name, guids=[])
        self.participant.nodes.append(node)
        self.participant.wire.tell()
        return node

    def remove_node(self, node: Node) -> None:
        """Announce that a node was removed."""
        self.participant.nodes = [other for other in self.participant.nodes if other is not node]
        self.participant.wire.tell()

    def set_endpoints(self, node: Node, writers: Iterable[bytes], readers: Iterable[bytes]) -> None:
        """Announce the endpoints of a node."""
        node.guids = [*writers, *readers]
        self.participant.wire.tell()

    def nodes(self) -> list[Node]:
        """Return all nodes, those of this program first."""
        return self.participant.wire.everywhere("nodes")

    def owners(self) -> dict[bytes, Node]:
        """Return the node of each endpoint, by the endpoint's identifier."""
        return {guid: node for node in self.nodes() for guid in node.guids}

    def is_complete(self) -> bool:
        """Return True: the graph is always complete."""
        return True

    def listen(self) -> None:
        """Do nothing: `Wire.hear` stores the announcements."""

    def endpoints(self, kind: bool, wire_topic: str | None = None, *, full: bool = False) -> list[DiscoveredEndpoint]:  # noqa: ARG002
        """Return the writers or readers on a topic, or on all topics."""
        return [
            SimpleNamespace(guid=each.guid.bytes, topic_name=each.topic_name, type_name=each.type_name, qos=each.qos)
            for each in self.participant.wire.everywhere("endpoints")
            if each.is_writer is kind and wire_topic in (None, each.topic_name)
        ]
