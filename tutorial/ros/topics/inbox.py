"""The messages of one topic, brought from the executor's thread to the event loop that awaits them."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile

from tutorial.errors import TutorialError
from tutorial.handoff import CallQueue
from tutorial.ros.topics.qos import reader_qos

__all__ = ["Inbox"]


class Inbox:
    """The messages of a topic, for the event loop that it is made on; of those not taken, the newest.

    Args:
        node: that subscribes; its thread must spin.
        kind: the class of the messages.
        topic: its full name.
        kept: how many messages wait at most to be taken.
        times_only: keep None instead of each message, which is not even decoded.
        qos: what to ask the publishers for; None for what fits all there are.
    """

    def __init__(
        self,
        node: Node,
        kind: Any,
        topic: str,
        kept: int = 100,
        times_only: bool = False,
        qos: QoSProfile | None = None,
    ) -> None:
        self._node = node
        self._topic = topic
        self._messages: deque[tuple[float, Any]] = deque(maxlen=kept)
        self._news = asyncio.Event()
        self._calls = CallQueue(asyncio.get_running_loop())
        self._scope = self._calls.scope(f"a look at {topic}")
        self._times_only = times_only
        self._subscription = node.create_subscription(
            kind, topic, self._on_message, qos or reader_qos(node, topic), raw=times_only
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
