"""A real node whose topics and callbacks are watched, and that others can publish to and wait for."""

from __future__ import annotations

import copy
import functools
import inspect
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

from tutorial.checks._diagnose import AT_ONCE, Misuse, lacks_self, no_self
from tutorial.checks._watch import Stumble, watch
from tutorial.errors import TutorialError

__all__ = ["CheckNode", "Ear", "Mouth", "WatchedNode"]

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
        destroyed: whether the learner has destroyed it.
        by_itself: whether that was done without the node.
    """

    topic: str
    message_type: type
    callback: Callable[..., Any]
    finished: int = 0
    stumble: Stumble | None = None
    subscription: Any = None
    destroyed: bool = False
    by_itself: bool = False

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
        destroyed: whether the learner has destroyed it.
        by_itself: whether that was done without the node.
    """

    topic: str
    message_type: type
    sent: list[tuple[Any, Any]] = field(default_factory=list)
    publisher: Any = None
    destroyed: bool = False
    by_itself: bool = False


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
        """Create a subscription, as rclpy does, whose callbacks are watched.

        Raises:
            Misuse: the callback is not a function, or one that cannot take a message.
        """
        _check_callback(callback, msg_type)
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
        _watch_destroy(ear, ear.subscription)
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
        _watch_destroy(mouth, publisher)
        self.mouths.append(mouth)
        return publisher

    def destroy_subscription(self, subscription: Any) -> bool:
        """Destroy a subscription, as rclpy does, and note it down."""
        for ear in self.ears:
            ear.destroyed = ear.destroyed or ear.subscription is subscription
        return bool(super().destroy_subscription(subscription))

    def destroy_publisher(self, publisher: Any) -> bool:
        """Destroy a publisher, as rclpy does, and note it down."""
        for mouth in self.mouths:
            mouth.destroyed = mouth.destroyed or mouth.publisher is publisher
        return bool(super().destroy_publisher(publisher))

    def create_timer(self, timer_period_sec: float, callback: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        """Create a timer, as rclpy does, whose callbacks are counted and watched."""
        self.timers_made += 1

        @functools.wraps(callback)
        def watched(*arguments: Any) -> None:
            with watch.call(getattr(callback, "__name__", "the timer's callback")):
                callback(*arguments)

        return super().create_timer(timer_period_sec, watched, *args, **kwargs)


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
        self._stumble: Stumble | None = None
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
        if error is None and self._stumble is not None:
            raise self._stumble

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
            _wait(lambda: ear.finished > before or self._stumble, "a message did not arrive")
            stumble = ear.stumble or self._stumble
            if stumble is not None:
                raise stumble

        return speak

    def _spin(self) -> None:
        while not self._stopping.is_set():
            try:
                self._executor.spin_once(timeout_sec=0.02)
            except Stumble as stumble:  # of a timer; those of subscriptions are kept by their ears
                self._stumble = self._stumble or stumble


def _check_callback(callback: Any, message_type: type) -> None:
    name = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in message_type.__name__)
    if not callable(callback):
        text = f"create_subscription is given {callback!r} in place of a function"
        raise Misuse(text, AT_ONCE.format(name=f"on{name}"))
    if inspect.ismethod(callback) and lacks_self(callback.__func__, 2):
        raise Misuse(f"{callback.__name__} cannot take a message", no_self(callback.__func__))


def _watch_destroy(made: Ear | Mouth, endpoint: Any) -> None:
    destroy = endpoint.destroy

    def watched() -> None:
        made.by_itself = not made.destroyed  # rclpy's node calls it, too
        made.destroyed = True
        destroy()

    endpoint.destroy = watched


def _wait(condition: Callable[[], object], complaint: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            raise TutorialError(complaint)
        time.sleep(0.0005)
