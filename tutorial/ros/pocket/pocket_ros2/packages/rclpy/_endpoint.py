"""The common base of publishers and subscriptions: an endpoint in DDS."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

from _rosidl.message import Message
from cyclonedds.core import DDSException
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import close, lock
from rclpy._endpoint_qos import INCOMPATIBLE_TYPE, POLICY_NAMES, to_dds
from rclpy._rclpy_pybind11 import Destroyable, InvalidHandle, RCLError
from rclpy._wire import payload_type
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.node import Node


class Endpoint(Destroyable):
    """Base of :class:`Publisher` and :class:`Subscription`; can be used from any thread.

    Args:
        node: the node that it belongs to.
        msg_type: the class of its messages.
        topic: the topic's name, as the program gives it.
        qos_profile: its QoS.

    Attributes:
        event_sources: DDS entities whose events wake the executor: incompatible partners, and messages.
        guid: its identifier in DDS.
    """

    _kind: type[DataWriter[Any] | DataReader[Any]]
    _noun: str
    """The endpoint's name in log lines, also for a program's own subclass."""
    _incompatible: int
    """Cyclone DDS's status of an incompatible partner."""
    _get_incompatible: str
    """Name of the method that returns details about this status."""
    _warning: str

    def __init__(self, node: Node, msg_type: type[Message], topic: str, qos_profile: QoSProfile) -> None:
        self._node = node
        self.msg_type = msg_type
        self.topic = topic
        self._topic_name = node.resolve_topic_name(topic)
        self.qos_profile = qos_profile
        qos = to_dds(qos_profile, msg_type, writer=self._kind is DataWriter)
        prefix = "" if qos_profile.avoid_ros_namespace_conventions else "rt"
        with lock:
            participant = node.context.graph.participant
            self._topic = Topic(participant, prefix + self._topic_name, payload_type(msg_type._definition.type_name))
            self._dds: Any = self._kind(participant, self._topic, qos)
            self._dds.set_status_mask(self._incompatible)
        self.event_sources: list[Any] = [self._dds]
        self.guid: bytes = self._dds.guid.bytes

    @property
    def topic_name(self) -> str:
        """The topic's full name."""
        self._require_handle()
        return self._topic_name

    def destroy(self) -> None:
        """Destroy the endpoint. Idempotent. Messages that wait for a callback are dropped.

        As in rclpy, the node still lists it. A real rclpy's executors fail on that, so a warning is logged once.
        """
        if self._node._remove(self, keep=True) and self._node.context.ok():
            kind = self._noun
            self._node.get_logger().warning(
                f"{kind}.destroy() does not tell the node: on a real ROS 2, every later spin of this node raises "
                f"InvalidHandle. Call node.destroy_{kind}({kind}) instead.",
                once=True,
            )

    def close(self) -> None:
        """Delete the DDS entities. Called by the node."""
        self._destroyed = True
        close(self._dds)
        close(self._topic)

    def report_events(self) -> None:
        """Log an incompatible partner. Called by the executor."""
        with suppress(DDSException):  # the endpoint may be destroyed in the meantime
            if not self._dds.take_status(self._incompatible):
                return
            policy = getattr(self._dds, self._get_incompatible)().last_policy_id
            if policy == INCOMPATIBLE_TYPE:
                text = f"Incompatible type on topic '{self.topic}', no messages will be sent to it."
            else:
                name = POLICY_NAMES.get(policy, "INVALID")
                text = f"{self._warning.format(topic=self.topic)} Last incompatible policy: {name}"
            self._node.get_logger().warning(text)

    def _count_matched(self, status: str, what: str) -> int:
        """Return the number of matched partners. ``status`` is the name of a method of Cyclone DDS."""
        self._require_handle()
        try:
            return int(getattr(self._dds, status)().current_count)
        except DDSException as error:
            raise self._explain(error, f"failed to get {what} count") from None

    def _require_context(self, what: str) -> None:
        if not self._node.context.ok():
            raise self._without_context(what)

    def _without_context(self, what: str) -> RCLError:
        return RCLError(f"{what}: {self._noun}'s context is invalid")

    def _explain(self, error: DDSException, what: str) -> RuntimeError:
        """Return the exception that rclpy raises instead of Cyclone DDS's error."""
        if self._destroyed:
            return InvalidHandle()
        if not self._node.context.ok():
            return self._without_context(what)
        return RCLError(f"{what}: {error}")
