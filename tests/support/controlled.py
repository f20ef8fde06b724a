"""Helpers for the tests of controllers: a node that records its calls, and a simulation."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from tutorial.simulation import Simulation


class Node:
    """A node that receives nothing.

    Attributes:
        sent: the published messages, by topic.
        types: the types of the published topics.
        topics: the subscribed topics.
        said: the lines of its log.
        publishers: the number of publishers that each subscription reports.
    """

    def __init__(self) -> None:
        self.sent, self.types, self.topics, self.said = {}, {}, [], []
        self.publishers = 1

    def create_publisher(self, message_type: type, topic: str, depth: int) -> Any:
        self.types[topic], self.sent[topic] = message_type, []
        return SimpleNamespace(publish=self.sent[topic].append)

    def create_subscription(
        self, message_type: type, topic: str, callback: Callable[..., object], depth: int, raw: bool = False
    ) -> Any:
        self.topics.append(topic)
        return SimpleNamespace(topic=topic, get_publisher_count=lambda: self.publishers)

    def destroy_subscription(self, subscription: Any) -> None:
        self.topics.remove(subscription.topic)

    def get_logger(self) -> Any:
        return SimpleNamespace(warning=lambda text, **_: self.said.append(text))


def on_course(publisher, placements, name="Tank", time_step=0.001, controllers=()) -> tuple[Node, Simulation]:
    """Return a node, and the simulation of a body with a publishing controller, after some other controllers."""
    node = Node()
    publisher.configure(SimpleNamespace(node=node, body=SimpleNamespace(name=name)))
    return node, Simulation(placements, [(name, each) for each in (*controllers, publisher)], time_step)


def stamps_ms(messages) -> list[float]:
    """Return the stamps of messages [ms]."""
    return [each.header.stamp.sec * 1000 + each.header.stamp.nanosec / 1e6 for each in messages]
