"""The learner's node, whose topics and callbacks are watched, and a node beside it that stands for other programs."""

from __future__ import annotations

import copy
import inspect
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any, TypeVar

from rclpy.exceptions import InvalidHandle
from rclpy.node import Node

from tutorial.checks._diagnose import AT_ONCE, Misuse, lacks_self, no_self
from tutorial.checks._watch import Failure, watch
from tutorial.errors import TutorialError
from tutorial.ros.node_thread import SpinThread
from tutorial.ros.tap import Call, Tap, TappedNode

__all__ = ["CheckThread", "WatchedEndpoint", "WatchedNode", "WatchedPublisher", "WatchedSubscription", "check_callback"]

PATIENCE = 10.0  # [s]; only what never comes takes so long

Endpoint = TypeVar("Endpoint")


class WatchedEndpoint(Tap):
    """A publisher or subscription of the learner's.

    Attributes:
        endpoint: rclpy's; None while it is being made.
    """

    endpoint: Any = None

    def made(self, endpoint: Any) -> None:
        """Keep it, to see in the end what has become of it."""
        super().made(endpoint)
        self.endpoint = endpoint

    @property
    def destroyed(self) -> bool:
        """Whether the learner has destroyed it, and not the whole node with it."""
        return _is_valid(self.node.get_name) and not _is_valid(lambda: self.endpoint.topic_name)


class WatchedSubscription(WatchedEndpoint):
    """A subscription of the learner's.

    Attributes:
        callback: the learner's.
        finished: how many calls of it have come to an end.
        failure: what the last one raised, if it did.
    """

    def __init__(self, node: Any, message_type: type, topic: str, callback: Any = None) -> None:
        super().__init__(node, message_type, topic)
        check_callback(callback, message_type)
        self.callback = callback
        self.finished = 0
        self.failure: Failure | None = None

    def received(self, call: Call, message: Any, info: dict[str, int]) -> None:
        """Call back, and keep what that raises."""
        try:
            with self._watched():
                call(message, info)
        except Failure as failure:
            self.failure = failure
        finally:
            self.finished += 1

    def _watched(self) -> AbstractContextManager[None]:
        return watch.call(getattr(self.callback, "__name__", "the callback"))


class WatchedPublisher(WatchedEndpoint):
    """A publisher of the learner's.

    Attributes:
        sent: copies of what was published.
    """

    def __init__(self, node: Any, message_type: type, topic: str) -> None:
        super().__init__(node, message_type, topic)
        self.sent: list[Any] = []

    def published(self, message: Any) -> None:
        """Keep a copy."""
        self.sent.append(copy.deepcopy(message))


class WatchedNode(TappedNode):
    """The node that the learner's controller is given. In everything that the learner sees it is rclpy's."""

    publisher_tap, subscription_tap = WatchedPublisher, WatchedSubscription

    def watched(self, kind: type[Endpoint]) -> list[Endpoint]:
        """Return the learner's subscriptions or publishers, destroyed or not, in the order in which they were made."""
        return [tap for tap in self.taps if isinstance(tap, kind)]


class CheckThread(SpinThread[WatchedNode]):
    """The learner's node on its thread, and another node, in the same context.

    Attributes:
        other: the one that stands for the other programs.
    """

    patience = None  # a callback that does not return is the watchdog's

    def __init__(self) -> None:
        super().__init__(WatchedNode, "tank")
        self.other = Node("check", context=self.node.context)

    def close(self) -> None:
        """End the thread and both nodes."""
        self.other.destroy_node()
        super().close()

    def send(self, subscription: WatchedSubscription, message: Any) -> None:
        """Publish a message for a subscription, once it is found, and wait until its callback has come to its end.

        Raises:
            TutorialError: the message does not arrive.
            Failure: the callback raised.
        """
        publisher = self.other.create_publisher(subscription.message_type, subscription.topic, 10)
        _wait(lambda: publisher.get_subscription_count() > 0, "no message reaches the subscription. Is its QoS 1?")
        before = subscription.finished
        publisher.publish(message)
        _wait(lambda: subscription.finished > before, "a message did not arrive")
        if subscription.failure is not None:
            raise subscription.failure


def check_callback(callback: Any, message_type: type) -> None:
    """Refuse a callback that cannot work, in the learner's words.

    Raises:
        Misuse: it is not a function, or one that cannot take a message.
    """
    name = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in message_type.__name__)
    if not callable(callback):
        text = f"create_subscription is given {callback!r} in place of a function"
        raise Misuse(text, AT_ONCE.format(name=f"on{name}"))
    if inspect.iscoroutinefunction(callback):
        text = f"{callback.__name__} is a coroutine function, async def, and nobody awaits it"
        raise Misuse(
            text, "A callback is a plain function, def: it puts the message away, or posts a call, and returns."
        )
    if inspect.ismethod(callback) and lacks_self(callback.__func__, 2):
        raise Misuse(f"{callback.__name__} cannot take a message", no_self(callback.__func__))


def _is_valid(ask: Callable[[], object]) -> bool:
    """Whether rclpy answers, as it does of what is not destroyed."""
    try:
        ask()
    except InvalidHandle:
        return False
    return True


def _wait(condition: Callable[[], object], complaint: str) -> None:
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            raise TutorialError(complaint)
        time.sleep(0.0005)
