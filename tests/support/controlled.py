"""What the tests of controllers need: a node that keeps what it is told, and a simulation."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from tutorial.simulation import Simulation


class Node:
    """A node on which nothing arrives.

    Attributes:
        sent: what was published, by topic.
        types: of the topics on which something is published.
        topics: those that are subscribed to.
        said: the lines of its log.
        publishers: how many each subscription has.
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
    """A node with a publisher, and a simulated body that is controlled by it, and before it by others."""
    node = Node()
    publisher.configure(SimpleNamespace(node=node, body=SimpleNamespace(name=name)))
    return node, Simulation(placements, [(name, each) for each in (*controllers, publisher)], time_step)


def stamps_ms(messages) -> list[float]:
    """When messages were stamped [ms]."""
    return [each.header.stamp.sec * 1000 + each.header.stamp.nanosec / 1e6 for each in messages]
