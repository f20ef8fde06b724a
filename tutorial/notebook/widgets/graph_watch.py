"""The data behind the picture of the node graph: publishers, subscribers and message rates."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Collection
from dataclasses import dataclass, field, replace

from rclpy.exceptions import NameValidationException
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from tutorial.errors import TutorialError
from tutorial.ros.topics.endpoints import publishers_on, subscriptions_on
from tutorial.ros.topics.listing import topics_with_types
from tutorial.ros.topics.names import EVERY_NODE_HAS, escape_name, full_name, is_hidden, message_class

MOST = 40  # the maximum number of nodes, and of topics, to show
LOOKS_KEPT = 7  # the number of counts that a topic's rate is computed from
DEPTH = 100  # number of messages that can wait for the executor; further messages are not counted


@dataclass(frozen=True)
class TopicNews:
    """A topic's type, rate and endpoints.

    Attributes:
        type_name: the type; several types are joined with commas.
        rate: messages per second [Hz]; None while unknown.
        publishers: full names of the nodes that publish, sorted.
        subscribers: full names of the nodes that subscribe, sorted.
    """

    type_name: str
    rate: float | None
    publishers: tuple[str, ...]
    subscribers: tuple[str, ...]

    def among(self, nodes: Collection[str]) -> TopicNews:
        """Return a copy that contains only these nodes."""
        publishers, subscribers = (tuple(filter(nodes.__contains__, n)) for n in (self.publishers, self.subscribers))
        return replace(self, publishers=publishers, subscribers=subscribers)


@dataclass(frozen=True)
class Topology:
    """A snapshot of the node graph without hidden nodes or topics. All names are escaped by `escape_name`.

    Attributes:
        nodes: the number of nodes with each full name; includes all nodes that publish to or subscribe to `topics`.
        topics: the topics by name.
        more: the number of nodes and topics that the snapshot omits.
    """

    nodes: dict[str, int] = field(default_factory=dict)
    topics: dict[str, TopicNews] = field(default_factory=dict)
    more: int = 0


class GraphWatch:
    """Uses a node to observe the node graph and count messages. Call `look` only in that node's callbacks.

    Args:
        node: the node that queries the graph and subscribes.
    """

    def __init__(self, node: Node) -> None:
        self._node = node
        self._meters: dict[str, _RateMeter | None] = {}
        self._known: set[str] = set()

    def look(self) -> Topology:
        """Query the graph. A query takes a few milliseconds, or longer for a large graph. Executor's thread only.

        If there are too many topics, the topics of the previous query take precedence.
        """
        found = {topic: types for topic, types in topics_with_types(self._node).items() if topic not in EVERY_NODE_HAS}
        chosen = sorted(sorted(found, key=lambda topic: topic not in self._known)[:MOST])
        news = {topic: self._news(topic, found[topic]) for topic in chosen}
        news = {topic: each for topic, each in news.items() if each.publishers or each.subscribers}
        self._known = set(news)
        for topic in self._meters.keys() - {topic for topic, each in news.items() if each.publishers}:
            if meter := self._meters.pop(topic):
                meter.close()
        nodes, more = self._nodes({name for each in news.values() for name in (*each.publishers, *each.subscribers)})
        topics = {escape_name(topic): each.among(nodes) for topic, each in news.items()}
        return Topology(nodes, topics, more + len(found) - len(chosen))

    def _nodes(self, on_topics: set[str]) -> tuple[dict[str, int], int]:
        """Count the nodes by name, preferring nodes that use topics; return the counts and the number of omitted names.

        A node that publishes or subscribes is counted even before discovery has found its name.
        """
        names = (full_name(*each) for each in self._node.get_node_names_and_namespaces())
        counts = Counter(escape_name(name) for name in names if not is_hidden(name))
        every = sorted(on_topics | counts.keys(), key=lambda name: (name not in on_topics, name))
        return {name: counts[name] or 1 for name in sorted(every[:MOST])}, len(every[MOST:])

    def _news(self, topic: str, types: list[str]) -> TopicNews:
        publishers = _visible(publishers_on(self._node, topic))
        subscribers = _visible(subscriptions_on(self._node, topic))
        rate = self._rate(topic, types) if publishers else None
        return TopicNews(", ".join(map(escape_name, types)), rate, publishers, subscribers)

    def _rate(self, topic: str, types: list[str]) -> float | None:
        """Return the rate of a topic's messages. The first call for a topic starts the count."""
        if topic not in self._meters:
            try:
                (type_name,) = types
                self._meters[topic] = _RateMeter(self._node, topic, message_class(type_name))
            except (ValueError, TypeError, TutorialError, NameValidationException):  # several types, an unknown type,
                self._meters[topic] = None  # or an invalid name
        meter = self._meters[topic]
        return meter.rate() if meter is not None else None


class _RateMeter:
    """Counts the messages on one topic without decoding them."""

    def __init__(self, node: Node, topic: str, kind: type) -> None:
        self._count = 0
        self._looks: deque[tuple[float, int]] = deque(maxlen=LOOKS_KEPT)
        self._node = node
        qos = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._subscription = node.create_subscription(kind, topic, self._on_message, qos, raw=True)

    def rate(self) -> float | None:
        """Return the average rate over the last few calls [Hz]; None on the first call."""
        self._looks.append((time.monotonic(), self._count))
        (began, before), (now, count) = self._looks[0], self._looks[-1]
        return (count - before) / (now - began) if now > began else None

    def close(self) -> None:
        self._node.destroy_subscription(self._subscription)

    def _on_message(self, _message: bytes) -> None:
        self._count += 1


def _visible(infos: list[TopicEndpointInfo]) -> tuple[str, ...]:
    """Return the full names of the endpoints' nodes, sorted, without duplicates or hidden nodes."""
    names = {full_name(info.node_name, info.node_namespace) for info in infos}
    return tuple(sorted(escape_name(name) for name in names if not is_hidden(name)))
