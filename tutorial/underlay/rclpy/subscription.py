"""Subscriptions."""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from _rosidl.message import Message
from cyclonedds.core import (
    DDSException,
    DDSStatus,
    Entity,
    InstanceState,
    ReadCondition,
    SampleState,
    ViewState,
)
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._dds_qos import POLICY_NAMES, to_dds
from rclpy._domain import close
from rclpy._rclpy_pybind11 import InvalidHandle, RCLError
from rclpy._wire import decode, payload_type, type_hash_of
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ["Subscription"]

SEQUENCE_NUMBER_UNSUPPORTED = 2**64 - 1
"""What rmw_cyclonedds, too, says for sequence numbers."""


class Subscription:
    """Receives a topic's messages; made by ``Node.create_subscription``.

    Its callback runs on the thread that spins. Everything else may be used from any thread.

    Args:
        node: that it belongs to.
        msg_type: class of its messages.
        topic: as the program called it.
        topic_name: in full.
        callback: called with each message, or with the message and a dict about it.
        qos_profile: how hard to try, and how many messages wait for the callback.
        raw: give the callback bytes instead of messages.
    """

    def __init__(
        self,
        node: Node,
        msg_type: type[Message],
        topic: str,
        topic_name: str,
        callback: Callable[..., object],
        qos_profile: QoSProfile,
        raw: bool,
    ) -> None:
        self._node = node
        self.msg_type = msg_type
        self.topic = topic
        self._topic_name = topic_name
        self.callback = callback
        self._wants_info = _wants_info(callback)
        self.qos_profile = qos_profile
        self.raw = raw
        participant = node.context.participant
        self._topic = Topic(participant, f"rt{topic_name}", payload_type(msg_type))
        self._reader = DataReader(participant, self._topic, to_dds(qos_profile, type_hash_of(msg_type), writer=False))
        self._reader.set_status_mask(DDSStatus.RequestedIncompatibleQos)
        self._condition = ReadCondition(self._reader, ViewState.Any | InstanceState.Any | SampleState.Any)
        self.guid: bytes = self._reader.guid.bytes
        self._destroyed = False

    @property
    def topic_name(self) -> str:
        """The topic's full name."""
        return self._topic_name

    def get_publisher_count(self) -> int:
        """Return the number of publishers that messages are received from."""
        try:
            return len(self._reader.get_matched_publications())
        except DDSException as error:
            raise InvalidHandle() if self._destroyed else RCLError(str(error)) from None

    def destroy(self) -> None:
        """Destroy it; may be called again. Messages that wait for the callback are dropped."""
        self._node.destroy_subscription(self)

    def execute(self) -> bool:
        """Take one message, if there is one, and call back with it. Called by the executor.

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
                self.callback(message, _info(payload))
            else:
                self.callback(message)
            return True
        return False

    def report_events(self) -> None:
        """Log a publisher that offers less than this subscription asks for. Called by the executor."""
        if self._reader.take_status(DDSStatus.RequestedIncompatibleQos):
            policy = self._reader.get_requested_incompatible_qos_status().last_policy_id
            self._node.get_logger().warning(
                f"New publisher discovered on topic '{self.topic}', offering incompatible QoS. No messages will be "
                f"received from it. Last incompatible policy: {POLICY_NAMES.get(policy, policy)}"
            )

    def close(self) -> None:
        """Leave DDS. Called by the node."""
        self._destroyed = True
        close(self._reader)
        close(self._topic)

    @property
    def event_source(self) -> DataReader[object]:
        """What the executor waits on for :meth:`report_events`."""
        return self._reader

    @property
    def message_source(self) -> Entity:
        """What the executor waits on for messages."""
        return self._condition

    def _take(self) -> Any:
        """Return the next message as it was received, None if there is none."""
        try:
            while samples := self._reader.take(1):
                if samples[0].sample_info.valid_data:
                    return samples[0]
        except DDSException:
            if not self._destroyed and self._node.context.ok():
                raise
        return None

    def _report_malformed(self, error: RCLError) -> None:
        self._node.get_logger().error(
            f"A message on topic '{self.topic}' is dropped: {error}. Others like it are dropped without a word.",
            once=True,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.destroy()


def _info(payload: Any) -> dict[str, int]:
    return {
        "source_timestamp": payload.sample_info.source_timestamp,
        "received_timestamp": time.time_ns(),
        "publication_sequence_number": SEQUENCE_NUMBER_UNSUPPORTED,
        "reception_sequence_number": SEQUENCE_NUMBER_UNSUPPORTED,
    }


def _wants_info(callback: Callable[..., object]) -> bool:
    """Whether a callback takes the message and information about it, instead of the message only.

    Raises:
        RuntimeError: it takes neither one argument nor two.
    """
    try:
        signature = inspect.signature(callback)
    except ValueError:  # some built-in functions have none
        return False
    for arguments in ((None,), (None, None)):
        try:
            signature.bind(*arguments)
        except TypeError:
            continue
        return len(arguments) == 2
    raise RuntimeError(
        "Subscription.__init__(): callback should be either be callable with one argument "
        "(to get only the message) or two (to get message and message info)"
    )
