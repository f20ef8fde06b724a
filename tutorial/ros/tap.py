"""A node whose messages can be looked at on their way: counted, copied, timed."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any

from rclpy.node import Node
from rclpy.publisher import Publisher

__all__ = ["Call", "Tap", "TappedNode"]

Call = Callable[[Any, dict[str, int]], object]
"""Takes a message and what rclpy knows about it, such as ``"source_timestamp"`` [ns]."""


class Tap:
    """Sits at one publisher or subscription of a `TappedNode`. A subclass overrides what it wants to see.

    Args:
        node: the node.
        message_type: the class of the messages.
        topic: as the program calls it.
        callback: the subscription's; None for a publisher.

    Attributes:
        topic: its full name, once rclpy has made the publisher or subscription.
    """

    def __init__(self, node: Any, message_type: type, topic: str, callback: Any = None) -> None:  # noqa: ARG002
        self.node = node
        self.message_type = message_type
        self.topic = topic

    def made(self, endpoint: Any) -> None:
        """See rclpy's publisher or subscription, which is not kept here: it may be given up."""
        self.topic = endpoint.topic_name

    def published(self, message: Any) -> None:
        """See a message that has been published. Runs on the thread that publishes."""

    def received(self, call: Call, message: Any, info: dict[str, int]) -> None:
        """See a message, and call back with it. Runs on the executor's thread.

        Args:
            call: calls back as rclpy would: with the message alone if the callback can do with that.
            message: the message.
            info: what rclpy knows about it, such as ``"source_timestamp"`` [ns].
        """
        call(message, info)


class TappedNode(Node):  # type: ignore[misc, unused-ignore]
    """A node with a tap at every publisher and subscription. In everything that its program sees it is rclpy's.

    A callback that is a coroutine function has no tap: rclpy awaits it.

    Attributes:
        publisher_tap, subscription_tap: the classes of its taps.
        taps: in the order in which they were made.
    """

    publisher_tap: type[Tap] = Tap
    subscription_tap: type[Tap] = Tap

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.taps: list[Any] = []
        super().__init__(*args, **kwargs)
        self.taps.clear()  # rclpy's own topics, such as /parameter_events

    def create_publisher(
        self, msg_type: type, topic: str, *args: Any, publisher_class: type[Publisher] = Publisher, **kwargs: Any
    ) -> Any:
        """Create a publisher, as rclpy does, whose tap sees what it publishes."""
        tap = self.publisher_tap(self, msg_type, topic)

        class TappedPublisher(publisher_class):  # type: ignore[misc, valid-type]
            def publish(self, msg: Any) -> None:
                super().publish(msg)
                tap.published(msg)

        publisher = super().create_publisher(msg_type, topic, *args, publisher_class=TappedPublisher, **kwargs)
        return self._add_tap(tap, publisher)

    def create_subscription(
        self, msg_type: type, topic: str, callback: Callable[..., Any], *args: Any, **kwargs: Any
    ) -> Any:
        """Create a subscription, as rclpy does, whose tap sees what it receives."""
        tap = self.subscription_tap(self, msg_type, topic, callback)
        call = _called_by_rclpy(callback)
        heard = callback if call is None else partial(tap.received, call)
        return self._add_tap(tap, super().create_subscription(msg_type, topic, heard, *args, **kwargs))

    def _add_tap(self, tap: Tap, endpoint: Any) -> Any:
        tap.made(endpoint)
        self.taps.append(tap)
        return endpoint


def _called_by_rclpy(callback: Callable[..., Any]) -> Call | None:
    """Return what calls a callback as rclpy does: with one argument if it can do with that, else with two.

    Returns:
        None where rclpy itself has to see it: a coroutine function, or what it refuses.
    """
    if not inspect.iscoroutinefunction(callback):
        with suppress(TypeError, ValueError):
            inspect.signature(callback).bind(None)
            return lambda message, _info: callback(message)
        with suppress(TypeError, ValueError):
            inspect.signature(callback).bind(None, None)
            return callback
    return None
