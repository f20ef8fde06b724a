"""Who publishes and subscribes to what, and how often: what the picture of the node graph is made of."""

from __future__ import annotations

import time
from collections import Counter, deque
from dataclasses import dataclass, field
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from tutorial.errors import TutorialError
from tutorial.ros.topics.listing import topics_with_types
from tutorial.ros.topics.names import EVERY_NODE_HAS, full_name, is_hidden, message_class

__all__ = ["GraphWatch", "TopicNews", "Topology"]

LOOKS_KEPT = 4  # of a topic's count, for its rate
DEPTH = 100  # messages that may wait for the executor without being lost to the count


@dataclass(frozen=True)
class TopicNews:
    """What is known of a topic.

    Attributes:
        type_name: its type; several are joined by commas.
        rate: messages per second [Hz], or None while it is not known.
        publishers: full names of the nodes that publish, sorted.
        subscribers: full names of the nodes that subscribe, sorted.
    """

    type_name: str
    rate: float | None
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]


@dataclass(frozen=True)
class Topology:
    """The node graph at one moment, without what is hidden.

    Attributes:
        nodes: how many nodes have each full name.
        topics: by name.
    """

    nodes: dict[str, int] = field(default_factory=dict)
    topics: dict[str, TopicNews] = field(default_factory=dict)


class GraphWatch:
    """Looks at the node graph through one node, and counts messages with it. It belongs to that node's executor.

    Args:
        node: that asks and subscribes.
        rates: count messages, too.
    """

    def __init__(self, node: Node, rates: bool = True) -> None:
        self._node = node
        self._rates = rates
        self._meters: dict[str, _RateMeter] = {}

    def look(self) -> Topology:
        """Ask for the graph; this takes some milliseconds. The executor's thread."""
        names = (full_name(name, space) for name, space in self._node.get_node_names_and_namespaces())
        nodes = Counter(sorted(name for name in names if not is_hidden(name)))
        topics: dict[str, TopicNews] = {}
        for topic, types in topics_with_types(self._node).items():
            if topic in EVERY_NODE_HAS:
                continue
            publishers = _visible(self._node.get_publishers_info_by_topic(topic))
            subscribers = _visible(self._node.get_subscriptions_info_by_topic(topic))
            if publishers or subscribers:
                rate = self._rate(topic, types) if publishers and self._rates else None
                topics[topic] = TopicNews(", ".join(types), rate, publishers, subscribers)
        for topic in tuple(self._meters):
            if topic not in topics or not topics[topic].publishers:
                self._meters.pop(topic).close()
        return Topology(dict(nodes), topics)

    def _rate(self, topic: str, types: list[str]) -> float | None:
        """How often a topic's messages come; from the first time on that this is asked."""
        if topic not in self._meters:
            self._meters[topic] = _RateMeter(self._node, topic, types)
        return self._meters[topic].rate()


class _RateMeter:
    """Counts the messages of one topic, which it does not even decode."""

    def __init__(self, node: Node, topic: str, types: list[str]) -> None:
        self._count = 0
        self._looks: deque[tuple[float, int]] = deque(maxlen=LOOKS_KEPT)
        self._node = node
        self._subscription: Any = None
        try:
            (type_name,) = types
            kind = message_class(type_name)
        except (ValueError, TutorialError):  # several types, or one that is not installed here
            return
        qos = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._subscription = node.create_subscription(kind, topic, self._on_message, qos, raw=True)

    def rate(self) -> float | None:
        """Messages per second since the last few looks [Hz]; None until there are two looks."""
        if self._subscription is None:
            return None
        self._looks.append((time.monotonic(), self._count))
        (began, before), (now, count) = self._looks[0], self._looks[-1]
        return (count - before) / (now - began) if now > began else None

    def close(self) -> None:
        if self._subscription is not None:
            self._node.destroy_subscription(self._subscription)

    def _on_message(self, _message: bytes) -> None:
        self._count += 1


def _visible(infos: list[TopicEndpointInfo]) -> tuple[str, ...]:
    """The full names of the nodes that endpoints belong to, each once."""
    names = {full_name(info.node_name, info.node_namespace) for info in infos}
    return tuple(sorted(name for name in names if not is_hidden(name)))
