"""The common base class of publishers and subscriptions."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from _rosidl.message import Message
from rclpy._domain import lock
from rclpy._middleware import TransportError
from rclpy._rclpy_pybind11 import Destroyable, InvalidHandle, RCLError
from rclpy._transport import Participant, Reader, Writer
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.node import Node


class Endpoint(Destroyable):
    """Base class of :class:`Publisher` and :class:`Subscription`; its methods can be called from any thread.

    Args:
        node: the endpoint's node.
        msg_type: the class of its messages.
        topic: the topic's name as the program gives it, neither expanded nor remapped.
        qos_profile: its QoS.

    Attributes:
        guid: the endpoint's identifier on the wire.
    """

    _noun: str
    """The word for this kind of endpoint in log lines. Subclasses defined by a program inherit it."""
    _warning: str

    def __init__(self, node: Node, msg_type: type[Message], topic: str, qos_profile: QoSProfile) -> None:
        self._node = node
        self.msg_type = msg_type
        self.topic = topic
        self._topic_name = node.resolve_topic_name(topic)
        self.qos_profile = qos_profile
        prefix = "" if qos_profile.avoid_ros_namespace_conventions else "rt"
        with lock:  # prevents a shutdown in the meantime
            participant = node.context.graph.participant
            self._wire = self._create(participant, prefix + self._topic_name, msg_type._definition.type_name)
        self.guid = self._wire.guid

    def _create(self, participant: Participant, topic_name: str, type_name: str) -> Writer | Reader:
        """Create the writer or reader."""
        raise NotImplementedError

    @property
    def topic_name(self) -> str:
        """The topic's full name."""
        self._require_handle()
        return self._topic_name

    def destroy(self) -> None:
        """Destroy the endpoint. Idempotent. Messages that are waiting for a callback are dropped.

        As in rclpy, the node still lists the endpoint. In the real rclpy, spinning such a node fails, so a warning is
        logged once.
        """
        if self._node._remove(self, keep=True) and self._node.context.ok():
            kind = self._noun
            self._node.get_logger().warning(
                f"{kind}.destroy() does not notify the node: on a real ROS 2, every later spin of this node raises "
                f"InvalidHandle. Call node.destroy_{kind}({kind}) instead.",
                once=True,
            )

    def close(self) -> None:
        """Delete the writer or reader. Called by the node."""
        self._destroyed = True
        self._wire.close()

    def report_events(self) -> None:
        """Log a warning about an incompatible partner, if there is one. Called by the executor."""
        with suppress(TransportError):  # the endpoint may be destroyed in the meantime
            if not (policy := self._wire.take_incompatible()):
                return
            if policy == "TYPE":
                text = f"Incompatible type on topic '{self.topic}', no messages will be sent to it."
            else:
                text = f"{self._warning.format(topic=self.topic)} Last incompatible policy: {policy}"
            self._node.get_logger().warning(text)

    def _count_matched(self, what: str) -> int:
        """Return the number of matched partners; ``what`` is the word for them in an error message."""
        self._require_handle()
        try:
            return self._wire.count_matched()
        except TransportError as error:
            raise self._explain(error, f"failed to get {what} count") from None

    def _require_context(self, what: str) -> None:
        if not self._node.context.ok():
            raise self._without_context(what)

    def _without_context(self, what: str) -> RCLError:
        return RCLError(f"{what}: {self._noun}'s context is invalid")

    def _explain(self, error: TransportError, what: str) -> RuntimeError:
        """Return the exception that rclpy raises instead of the middleware's error."""
        if self._destroyed:
            return InvalidHandle()
        if not self._node.context.ok():
            return self._without_context(what)
        return RCLError(f"{what}: {error}")
