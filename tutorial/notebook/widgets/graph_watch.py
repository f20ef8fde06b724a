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
from tutorial.ros.topics.endpoints import publishers_on, subscriptions_on
from tutorial.ros.topics.listing import topics_with_types
from tutorial.ros.topics.names import EVERY_NODE_HAS, escape_name, full_name, is_hidden, is_valid_topic, message_class

__all__ = ["GraphWatch", "TopicNews", "Topology"]

MOST_TOPICS = 40  # that are looked into
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
    """The node graph at one moment, without what is hidden; all names are as `escape_name`.

    Attributes:
        nodes: how many nodes have each full name.
        topics: by name.
        more: how many topics there are beside these, which were not looked into.
    """

    nodes: dict[str, int] = field(default_factory=dict)
    topics: dict[str, TopicNews] = field(default_factory=dict)
    more: int = 0


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
        self._known: set[str] = set()

    def look(self) -> Topology:
        """Ask for the graph; this takes some milliseconds, or more where there is much. The executor's thread.

        Of very many topics, those that it has looked into before come first, whoever brings others.
        """
        names = (full_name(name, space) for name, space in self._node.get_node_names_and_namespaces())
        nodes = Counter(sorted(escape_name(name) for name in names if not is_hidden(name)))
        found = {topic: types for topic, types in topics_with_types(self._node).items() if topic not in EVERY_NODE_HAS}
        chosen = sorted(sorted(found, key=lambda topic: topic not in self._known)[:MOST_TOPICS])
        news = {topic: self._news(topic, found[topic]) for topic in chosen}
        self._known = {topic for topic, each in news.items() if each.publishers or each.subscribers}
        for topic in tuple(self._meters):
            if topic not in news or not news[topic].publishers:
                self._meters.pop(topic).close()
        topics = {escape_name(topic): each for topic, each in news.items() if topic in self._known}
        return Topology(dict(nodes), topics, len(found) - len(chosen))

    def _news(self, topic: str, types: list[str]) -> TopicNews:
        publishers = _visible(publishers_on(self._node, topic))
        subscribers = _visible(subscriptions_on(self._node, topic))
        rate = self._rate(topic, types) if publishers and self._rates else None
        return TopicNews(", ".join(map(escape_name, types)), rate, publishers, subscribers)

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
        if not is_valid_topic(topic):  # no node can subscribe to it
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
    return tuple(sorted(escape_name(name) for name in names if not is_hidden(name)))
