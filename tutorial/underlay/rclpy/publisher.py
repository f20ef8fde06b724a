"""Publishers."""

from __future__ import annotations

from types import TracebackType
from typing import TYPE_CHECKING, Self

from _rosidl.message import Message
from cyclonedds.core import DDSException, DDSStatus
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from rclpy._dds_qos import POLICY_NAMES, to_dds
from rclpy._domain import close
from rclpy._rclpy_pybind11 import InvalidHandle, RCLError
from rclpy._wire import encode, payload_type, type_hash_of
from rclpy.duration import Duration, Infinite
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.node import Node

__all__ = ["Publisher"]


class Publisher:
    """Sends messages to a topic; made by ``Node.create_publisher``. May be used from any thread.

    Args:
        node: that it belongs to.
        msg_type: class of its messages.
        topic: as the program called it.
        topic_name: in full.
        qos_profile: how hard to try.
    """

    def __init__(
        self, node: Node, msg_type: type[Message], topic: str, topic_name: str, qos_profile: QoSProfile
    ) -> None:
        self._node = node
        self.msg_type = msg_type
        self.topic = topic
        self._topic_name = topic_name
        self.qos_profile = qos_profile
        self._payload = payload_type(msg_type)
        participant = node.context.participant
        self._topic = Topic(participant, f"rt{topic_name}", self._payload)
        self._writer = DataWriter(participant, self._topic, to_dds(qos_profile, type_hash_of(msg_type), writer=True))
        self._writer.set_status_mask(DDSStatus.OfferedIncompatibleQos)
        self.guid: bytes = self._writer.guid.bytes
        self._destroyed = False

    @property
    def topic_name(self) -> str:
        """The topic's full name."""
        return self._topic_name

    def publish(self, msg: Message | bytes) -> None:
        """Send a message, given as such or already serialised.

        Raises:
            TypeError: it is of another type, or a field holds what its type cannot.
            InvalidHandle: the publisher has been destroyed.
            RCLError: the context has been shut down.
        """
        if isinstance(msg, self.msg_type):
            data = encode(msg)
        elif isinstance(msg, bytes):
            data = msg
        else:
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        try:
            self._writer.write(self._payload(data))
        except DDSException as error:
            raise self._explain(error) from None

    def get_subscription_count(self) -> int:
        """Return the number of subscriptions that receive what is published."""
        try:
            return len(self._writer.get_matched_subscriptions())
        except DDSException as error:
            raise self._explain(error) from None

    def wait_for_all_acked(self, timeout: Duration = Infinite) -> bool:
        """Wait until every reliable subscription has received everything; False if time runs out."""
        try:
            return bool(self._writer.wait_for_acks(timeout.nanoseconds))
        except AttributeError:  # what cyclonedds 11.0.1 raises when time runs out
            return False
        except DDSException as error:
            raise self._explain(error) from None

    def destroy(self) -> None:
        """Destroy it; may be called again."""
        self._node.destroy_publisher(self)

    def report_events(self) -> None:
        """Log a subscription that asks for more than this publisher offers. Called by the executor."""
        if self._writer.take_status(DDSStatus.OfferedIncompatibleQos):
            policy = self._writer.get_offered_incompatible_qos_status().last_policy_id
            self._node.get_logger().warning(
                f"New subscription discovered on topic '{self.topic}', requesting incompatible QoS. No messages "
                f"will be sent to it. Last incompatible policy: {POLICY_NAMES.get(policy, policy)}"
            )

    def close(self) -> None:
        """Leave DDS. Called by the node."""
        self._destroyed = True
        close(self._writer)
        close(self._topic)

    @property
    def event_source(self) -> DataWriter[object]:
        """What the executor waits on for :meth:`report_events`."""
        return self._writer

    def _explain(self, error: DDSException) -> RuntimeError:
        if self._destroyed:
            return InvalidHandle()
        if not self._node.context.ok():
            return RCLError("Failed to publish: publisher's context is invalid")
        return RCLError(f"Failed to publish: {error}")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.destroy()
