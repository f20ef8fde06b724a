"""The interface to the middleware: send and receive bytes, wait, and list participants and endpoints.

A middleware is a module with the exception ``TransportError`` and the function ``join(domain_id)``, which returns a
`Participant`. The module's functions ``encode_nodes(guid, nodes)`` and ``decode_nodes(data)`` encode and decode a
participant's announcement of its nodes. Bytes 4 to 19 of an announcement are the participant's identifier.
`rclpy._cyclone` is the middleware based on Cyclone DDS; the book's ``drive`` page uses a different middleware.
`rclpy._middleware` selects the middleware in use. All methods can be called from any thread.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from rclpy.qos import QoSProfile, qos_profile_unknown
from rclpy.topic_endpoint_info import TopicEndpointTypeEnum

PUBLISHERS, SUBSCRIPTIONS = TopicEndpointTypeEnum.PUBLISHER, TopicEndpointTypeEnum.SUBSCRIPTION


@dataclass
class NodeInfo:
    """A node, with the identifiers of its writers and readers."""

    node_namespace: str
    node_name: str
    writers: list[bytes] = field(default_factory=list)
    readers: list[bytes] = field(default_factory=list)


@dataclass
class EndpointInfo:
    """A writer or reader in the domain.

    Attributes:
        kind: PUBLISHERS for a writer, SUBSCRIPTIONS for a reader.
        guid: the endpoint's identifier (16 bytes).
        topic_name: the topic's name on the wire, such as ``"rt/joy"``.
        type_name: the type's name on the wire, such as ``"sensor_msgs::msg::dds_::Joy_"``.
        type_hash: such as ``"RIHS01_..."``; "" if unknown or not requested.
        qos: its policies; unknown if not requested.
    """

    kind: TopicEndpointTypeEnum
    guid: bytes
    topic_name: str
    type_name: str
    type_hash: str = ""
    qos: QoSProfile = field(default_factory=lambda: qos_profile_unknown)


class Entity(Protocol):
    """The common base class of writers and readers."""

    guid: bytes

    def count_matched(self) -> int:
        """Return the number of matched partners."""

    def take_incompatible(self) -> str:
        """Return why a new partner is incompatible: a policy's name or ``"TYPE"``; "" if there is no such partner."""

    def close(self) -> None:
        """Delete the writer or reader. Idempotent."""


class Writer(Entity, Protocol):
    """Sends a topic's messages."""

    def write(self, data: bytes) -> None:
        """Send a serialized message."""

    def wait_for_acks(self, timeout_ns: int) -> bool:
        """Wait until every reliable reader has received all messages; return False if the timeout [ns] expires."""


class Reader(Entity, Protocol):
    """Receives a topic's messages."""

    def take(self) -> tuple[bytes, int] | None:
        """Return the next message and the time when it was sent [ns]; None if there is no message."""


class Waiter(Protocol):
    """Waits for messages and events."""

    def watch(self, endpoints: Sequence[tuple[Entity, Any]]) -> None:
        """Watch these writers and readers in all later waits; each one is paired with its owner."""

    def wait(self, timeout: float) -> list[Any]:
        """Wait for a message, an incompatible partner or a call to :meth:`wake`, or until the timeout [s] expires.

        Returns:
            The owners of the readers that have messages, in the order in which the readers were passed to
            :meth:`watch`, and None for any other event.
        """

    def wake(self) -> None:
        """End the current wait or, if none is active, the next wait; a signal handler can call this method."""

    def close(self) -> None:
        """Delete the waiter. Idempotent."""


class Participant(Protocol):
    """A program's membership in a domain."""

    guid: bytes

    def create_writer(self, topic_name: str, type_name: str, profile: QoSProfile) -> Writer:
        """Create a writer for a message type, such as ``"sensor_msgs/msg/Joy"``."""

    def create_reader(
        self, topic_name: str, type_name: str, profile: QoSProfile, *, ignore_own: bool = False
    ) -> Reader:
        """Create a reader for a message type; ``ignore_own`` makes it ignore this participant's own writers."""

    def create_waiter(self) -> Waiter:
        """Create a waiter."""

    def participants(self, *, only_ros: bool = False) -> set[bytes]:
        """Return the identifiers of all live participants, or only of those that use ROS 2."""

    def endpoints(
        self, kind: TopicEndpointTypeEnum, topic_name: str | None = None, *, full: bool = False
    ) -> list[EndpointInfo]:
        """Return the writers or readers on one topic or on all topics.

        Args:
            kind: PUBLISHERS or SUBSCRIPTIONS.
            topic_name: the topic's name on the wire; None for all topics.
            full: also read each endpoint's policies, which takes up to 0.1 ms per endpoint.
        """

    def leave(self) -> None:
        """Leave the domain, and delete everything that this participant created."""
