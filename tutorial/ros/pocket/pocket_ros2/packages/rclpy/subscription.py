"""Subscriptions."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from _rosidl.message import Message
from cyclonedds.core import DDSException, DDSStatus, InstanceState, ReadCondition, SampleState, ViewState
from cyclonedds.sub import DataReader
from rclpy._domain import lock
from rclpy._endpoint import Endpoint
from rclpy._rclpy_pybind11 import RCLError
from rclpy._wire import decode
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.node import Node

Callback = Callable[..., object]


class Subscription(Endpoint):
    """Receives a topic's messages; created by ``Node.create_subscription``.

    Its callback runs on the thread that spins. Everything else can be used from any thread.

    Args:
        node: the node that it belongs to.
        msg_type: the class of its messages.
        topic: the topic's name, as the program gives it.
        callback: called with each message, or with the message and a dict about it.
        qos_profile: its QoS, including how many messages can wait for the callback.
        raw: pass bytes to the callback instead of messages.
    """

    _kind = DataReader
    _noun = "subscription"
    _incompatible = DDSStatus.RequestedIncompatibleQos
    _get_incompatible = "get_requested_incompatible_qos_status"
    _warning = (
        "New publisher discovered on topic '{topic}', offering incompatible QoS. No messages will be received from it."
    )

    def __init__(
        self, node: Node, msg_type: type[Message], topic: str, callback: Callback, qos_profile: QoSProfile, raw: bool
    ) -> None:
        self.callback = callback
        self.raw = raw
        self._has_reported_malformed = False
        super().__init__(node, msg_type, topic, qos_profile)
        with lock:
            any_state = ViewState.Any | InstanceState.Any | SampleState.Any
            self.event_sources.append(ReadCondition(self._dds, any_state))

    @property
    def callback(self) -> Callback:
        """The function that is called with each message, or with the message and a dict about it."""
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
        """Return the number of publishers that messages are received from."""
        return self._count_matched("get_subscription_matched_status", "publisher")

    def execute(self) -> bool:
        """Take a message, if there is one, and call the callback with it. Called by the executor.

        Returns:
            Whether the callback was called.
        """
        while (payload := self._take()) is not None:
            try:
                message = payload.data if self.raw else decode(payload.data, self.msg_type)
            except RCLError as error:
                self._report_malformed(error)
                continue
            if self._wants_info:
                self._callback(message, _info(payload))
            else:
                self._callback(message)
            return True
        return False

    def _take(self) -> Any:
        """Return the next message undecoded, or None if there is none."""
        try:
            while not self._destroyed and (samples := self._dds.take(1)):
                if samples[0].sample_info.valid_data:
                    return samples[0]
        except DDSException:
            if not self._destroyed and self._node.context.ok():
                raise
        return None

    def _report_malformed(self, error: RCLError) -> None:
        if not self._has_reported_malformed:
            self._has_reported_malformed = True
            self._node.get_logger().error(
                f"A message on topic '{self.topic}' is dropped: {error}. Others like it will be dropped silently."
            )


def _info(payload: Any) -> dict[str, int | None]:
    return {
        "source_timestamp": payload.sample_info.source_timestamp,
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
