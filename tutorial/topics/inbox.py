"""The messages of one topic, brought from the executor's thread to the event loop that awaits them."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from importlib import import_module
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from tutorial.errors import TutorialError
from tutorial.handoff import CallQueue

__all__ = ["Inbox", "message_class", "reader_qos"]

SENSOR_DEPTH = 5  # of rclpy's qos_profile_sensor_data, which ros2 begins with


def message_class(type_name: str) -> Any:
    """Return the class of a message type.

    Args:
        type_name: such as ``"sensor_msgs/msg/Joy"``.

    Raises:
        TutorialError: there is none.
    """
    try:
        package, kind, name = type_name.split("/")
        return getattr(import_module(f"{package}.{kind}"), name)
    except (ValueError, ImportError, AttributeError):
        raise TutorialError(f"The message type '{type_name}' is invalid") from None


def reader_qos(node: Node, topic: str, depth: int = SENSOR_DEPTH) -> QoSProfile:
    """Choose what a subscription can ask for so that all publishers of a topic fit it, as ``ros2`` does.

    Args:
        node: that asks.
        topic: its full name.
        depth: how many messages wait for the callback.
    """
    offered = [info.qos_profile for info in node.get_publishers_info_by_topic(topic)]
    reliable = bool(offered) and all(qos.reliability == ReliabilityPolicy.RELIABLE for qos in offered)
    lasting = bool(offered) and all(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in offered)
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if lasting else DurabilityPolicy.VOLATILE,
    )


class Inbox:
    """The messages of a topic, for the event loop that it is made on; of those not taken, the newest.

    Args:
        node: that subscribes; its thread must spin.
        kind: the class of the messages.
        topic: its full name.
        kept: how many messages wait at most to be taken.
        times_only: keep None instead of each message, which is not even decoded.
    """

    def __init__(self, node: Node, kind: Any, topic: str, kept: int = 100, times_only: bool = False) -> None:
        self._node = node
        self._topic = topic
        self._messages: deque[tuple[float, Any]] = deque(maxlen=kept)
        self._news = asyncio.Event()
        self._calls = CallQueue(asyncio.get_running_loop())
        self._scope = self._calls.scope(f"a look at {topic}")
        self._times_only = times_only
        self._subscription = node.create_subscription(
            kind, topic, self._on_message, reader_qos(node, topic), raw=times_only
        )

    async def next(self, timeout: float | None = None) -> tuple[float, Any]:
        """Wait for the next message; (when it came, of `time.monotonic` [s], the message).

        Raises:
            TutorialError: none came in time.
        """
        try:
            async with asyncio.timeout(timeout):
                while not self._messages:
                    self._news.clear()
                    await self._news.wait()
        except TimeoutError:
            count = self._node.count_publishers(self._topic)
            raise TutorialError(
                f"no message came on {self._topic} within {timeout:g} s; it has {count} "
                f"publisher{'s' if count != 1 else ''}. Start the program that publishes it, or wait longer."
            ) from None
        return self._messages.popleft()

    def close(self) -> None:
        """Take the subscription back. Idempotent."""
        self._calls.close()
        self._node.destroy_subscription(self._subscription)

    def _on_message(self, message: Any) -> None:
        """Keep the message with its time, post, and return. The thread that spins."""
        self._messages.append((time.monotonic(), None if self._times_only else message))
        self._scope.call_latest("news", self._news.set)
