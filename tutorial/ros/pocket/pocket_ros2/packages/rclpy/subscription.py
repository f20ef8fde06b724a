"""Subscriptions."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from _rosidl.message import Message
from rclpy._endpoint import Endpoint
from rclpy._middleware import TransportError
from rclpy._rclpy_pybind11 import RCLError
from rclpy._transport import Participant, Reader
from rclpy._wire import decode
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.node import Node

Callback = Callable[..., object]


class Subscription(Endpoint):
    """Receives a topic's messages; created by ``Node.create_subscription``.

    Its callback runs on the thread that spins. The subscription itself can be used from any thread.

    Args:
        node: the subscription's node.
        msg_type: the class of its messages.
        topic: the topic's name, as the program gives it.
        callback: called with each message and, if it requires two arguments, a dict of the message's metadata.
        qos_profile: its QoS, including the number of messages that can wait for the callback.
        raw: pass bytes to the callback instead of messages.
    """

    _noun = "subscription"
    _warning = (
        "New publisher discovered on topic '{topic}', offering incompatible QoS. No messages will be received from it."
    )
    _wire: Reader

    def __init__(
        self, node: Node, msg_type: type[Message], topic: str, callback: Callback, qos_profile: QoSProfile, raw: bool
    ) -> None:
        self.callback = callback
        self.raw = raw
        self._has_reported_malformed = False
        super().__init__(node, msg_type, topic, qos_profile)

    def _create(self, participant: Participant, topic_name: str, type_name: str) -> Reader:
        return participant.create_reader(topic_name, type_name, self.qos_profile)

    @property
    def callback(self) -> Callback:
        """The function called with each message and, if it requires two arguments, a dict of the message's metadata."""
        return self._callback

    @callback.setter
    def callback(self, value: Callback) -> None:
        self._wants_info = not _accepts(value, 1)
        if self._wants_info and not _accepts(value, 2):
            raise RuntimeError(
                "Subscription.__init__(): callback should be either be callable with one argument"
                "(to get only the message) or two (to get message and message info)"
            )
        self._callback = value

    def get_publisher_count(self) -> int:
        """Return the number of publishers that the subscription receives messages from."""
        return self._count_matched("publisher")

    def execute(self) -> bool:
        """Take the next message if one has arrived, and call the callback with it. Called by the executor.

        Returns:
            Whether the callback was called.
        """
        while (sample := self._take()) is not None:
            data, sent_at = sample
            try:
                message = data if self.raw else decode(data, self.msg_type)
            except RCLError as error:
                self._report_malformed(error)
                continue
            if self._wants_info:
                self._callback(message, _info(sent_at))
            else:
                self._callback(message)
            return True
        return False

    def _take(self) -> tuple[bytes, int] | None:
        """Return the next message, still encoded, and the time when it was sent [ns]; None if there is no message."""
        try:
            return None if self._destroyed else self._wire.take()
        except TransportError:
            if not self._destroyed and self._node.context.ok():
                raise
        return None

    def _report_malformed(self, error: RCLError) -> None:
        if not self._has_reported_malformed:
            self._has_reported_malformed = True
            self._node.get_logger().error(
                f"A message on topic '{self.topic}' was dropped: {error}. Further malformed messages will be dropped "
                "silently."
            )


def _info(sent_at: int) -> dict[str, int | None]:
    return {
        "source_timestamp": sent_at,
        "received_timestamp": time.time_ns(),
        "publication_sequence_number": None,  # as in ROS 2 with Cyclone DDS
        "reception_sequence_number": None,
    }


def _accepts(callback: Callback, count: int) -> bool:
    try:
        inspect.signature(callback).bind(*[None] * count)
    except TypeError:
        return False
    return True
