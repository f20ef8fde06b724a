"""A real node whose topics and callbacks are watched, and that others can publish to and wait for."""

from __future__ import annotations

import copy
import functools
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Stumble, watch
from tutorial.errors import TutorialError

__all__ = ["CheckNode", "Ear", "Mouth", "ear_on", "mouth_on"]

PATIENCE = 10.0  # [s]; only what never comes takes so long


@dataclass
class Ear:
    """A subscription of the learner's.

    Attributes:
        topic: its full name.
        message_type: the class of its messages.
        callback: the learner's.
        finished: how many calls of it have come to an end.
        stumble: what the last one raised, if it did.
        subscription: rclpy's.
    """

    topic: str
    message_type: type
    callback: Callable[..., Any]
    finished: int = 0
    stumble: Stumble | None = None
    subscription: Any = None

    def hear(self, *arguments: Any) -> None:
        """Call back on this thread, with the message, and with information about it if the callback takes that.

        Raises:
            Stumble: the callback raised.
        """
        with watch.call(getattr(self.callback, "__name__", "the callback")):
            self.callback(*arguments)


@dataclass
class Mouth:
    """A publisher of the learner's.

    Attributes:
        topic: its full name.
        message_type: the class of its messages.
        sent: what was published: copies of the messages, each with what `on_publish` made of the moment.
        publisher: rclpy's.
    """

    topic: str
    message_type: type
    sent: list[tuple[Any, Any]] = field(default_factory=list)
    publisher: Any = None


class WatchedNode(Node):  # type: ignore[misc, unused-ignore]
    """The node that the learner's controller is given. In everything that the learner sees it is rclpy's.

    Attributes:
        ears, mouths: the learner's subscriptions and publishers.
        timers_made: how many timers were created.
        on_publish: called whenever something is published; what it returns is kept with the message.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.ears: list[Ear] = []
        self.mouths: list[Mouth] = []
        self.timers_made = 0
        self.on_publish: Callable[[], Any] = lambda: None
        super().__init__(*args, **kwargs)
        self.ears.clear()  # rclpy's own topics, such as /parameter_events
        self.mouths.clear()

    def create_subscription(
        self, msg_type: type, topic: str, callback: Callable[..., Any], *args: Any, **kwargs: Any
    ) -> Any:
        """Create a subscription, as rclpy does, whose callbacks are watched."""
        ear = Ear(topic, msg_type, callback)

        @functools.wraps(callback)  # rclpy finds out from the signature what the callback takes
        def watched(*arguments: Any) -> None:
            try:
                ear.hear(*arguments)
            except Stumble as stumble:
                ear.stumble = stumble
            finally:
                ear.finished += 1

        ear.subscription = super().create_subscription(msg_type, topic, watched, *args, **kwargs)
        ear.topic = ear.subscription.topic_name
        self.ears.append(ear)
        return ear.subscription

    def create_publisher(self, msg_type: type, topic: str, *args: Any, **kwargs: Any) -> Any:
        """Create a publisher, as rclpy does, that keeps a copy of what it publishes."""
        publisher: Any = super().create_publisher(msg_type, topic, *args, **kwargs)
        mouth = Mouth(publisher.topic_name, msg_type, publisher=publisher)
        publish = publisher.publish

        def watched(message: Any) -> None:
            publish(message)
            mouth.sent.append((copy.deepcopy(message), self.on_publish()))

        publisher.publish = watched
        self.mouths.append(mouth)
        return publisher

    def create_timer(self, *args: Any, **kwargs: Any) -> Any:
        """Create a timer, as rclpy does, and count it."""
        self.timers_made += 1
        return super().create_timer(*args, **kwargs)


class CheckNode:
    """A context with two nodes, the learner's and another, whose callbacks run on a thread called ``executor``.

    Attributes:
        node: the learner's.
        other: the one that stands for the other programs.
    """

    def __init__(self) -> None:
        self._context = Context()
        rclpy.init(args=[], context=self._context)
        self.node = WatchedNode("tank", context=self._context)
        self.other = Node("check", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._spin, name="executor", daemon=True)
        self._thread.start()

    def __enter__(self) -> CheckNode:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stopping.set()
        self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()
        self.other.destroy_node()
        self._context.try_shutdown()

    def speaker(self, ear: Ear) -> Callable[[Any], None]:
        """Make a publisher that an ear hears, once it does.

        Returns:
            A function that publishes a message and returns when the ear's callback has come to its end; it raises the
            `Stumble` of that.

        Raises:
            TutorialError: the two don't find each other.
        """
        publisher = self.other.create_publisher(ear.message_type, ear.topic, 10)
        _wait(lambda: publisher.get_subscription_count() > 0, "no message reaches the subscription. Is its QoS 1?")

        def speak(message: Any) -> None:
            before = ear.finished
            ear.stumble = None
            publisher.publish(message)
            _wait(lambda: ear.finished > before, "a message did not arrive")
            if ear.stumble is not None:
                raise ear.stumble

        return speak

    def _spin(self) -> None:
        while not self._stopping.is_set():
            self._executor.spin_once(timeout_sec=0.02)


def ear_on(node: WatchedNode, topic: str, message_type: type, call: str) -> tuple[Finding, Ear | None]:
    """Find the subscription that the exercise asks for.

    Args:
        node: the learner's.
        topic: its full name.
        message_type: of its messages.
        call: how the subscription is made.
    """
    if not node.ears:
        return wrong("configure subscribes to nothing", f"Most likely the call is missing: {call}."), None
    for ear in node.ears:
        if ear.topic == topic and ear.message_type is message_type:
            return right(f"it listens to {topic}"), ear
    return _other_topic(node.ears[0], "listens to", topic, message_type), None


def mouth_on(node: WatchedNode, topic: str, message_type: type, call: str) -> tuple[Finding, Mouth | None]:
    """Find the publisher that the exercise asks for; the arguments are those of `ear_on`."""
    if not node.mouths:
        return wrong("configure makes no publisher", f"Most likely the call is missing: {call}."), None
    for mouth in node.mouths:
        if mouth.topic == topic and mouth.message_type is message_type:
            return right(f"it publishes on {topic}"), mouth
    return _other_topic(node.mouths[0], "publishes on", topic, message_type), None


def _other_topic(made: Ear | Mouth, does: str, topic: str, message_type: type) -> Finding:
    if made.topic == topic:
        text = f"{topic} {does.split(maxsplit=1)[0]} messages of the type {made.message_type.__name__}"
        return wrong(text, f"Its messages are of the type {message_type.__name__}: give that class first.")
    body, _, rest = topic.lstrip("/").partition("/")
    text = f"on a body called {body}, it {does} {made.topic}, not {topic}" if rest else f"it {does} {made.topic}"
    if not rest:
        return wrong(f"{text}, not {topic}", f"Most likely the topic's name is another: it is {body!r}.")
    if made.topic.partition("/")[2].partition("/")[2] == rest:
        return wrong(text, "The body's name is written into the topic: take it from config.body.name.")
    return wrong(text, f'Most likely the topic\'s name is another: it is f"{{config.body.name}}/{rest}".')


def _wait(condition: Callable[[], object], complaint: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            raise TutorialError(complaint)
        time.sleep(0.0005)
