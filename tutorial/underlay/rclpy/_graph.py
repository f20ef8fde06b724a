"""Who is there: nodes, and the publishers and subscriptions on topics.

DDS knows participants, writers and readers, not nodes. In ROS 2 every participant tells on the topic
``ros_discovery_info`` which nodes it holds and which endpoints are whose; the whole list again at each change.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from cyclonedds.builtin import (
    BuiltinDataReader,
    BuiltinTopicDcpsParticipant,
    BuiltinTopicDcpsPublication,
    BuiltinTopicDcpsSubscription,
)
from cyclonedds.core import DDSException, InstanceState, ReadCondition, SampleState, ViewState
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import close, lock
from rclpy._rclpy_pybind11 import RCLError
from rclpy._wire import decode, encode, payload_type
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

if TYPE_CHECKING:
    from cyclonedds.domain import DomainParticipant

__all__ = ["Endpoint", "Graph", "gids_of"]

MANY = 4096
"""More endpoints than are ever read at once."""

Endpoint = Any
"""A discovered writer or reader: ``cyclonedds.builtin.DcpsEndpoint``."""

_BOTH_SIDES = (Policy.Reliability.Reliable(2**63 - 1), Policy.Durability.TransientLocal)
_WRITER_QOS = Qos(
    *_BOTH_SIDES,
    Policy.History.KeepLast(1),
    Policy.DurabilityService(0, Policy.History.KeepLast(1), -1, -1, -1),
    Policy.WriterDataLifecycle(autodispose=False),
)
_READER_QOS = Qos(*_BOTH_SIDES, Policy.History.KeepAll, Policy.IgnoreLocal.Participant)


def gid_of(guid: bytes) -> Gid:
    """Return a DDS identifier, 16 bytes, as ROS 2 sends it."""
    return Gid(data=list(guid))


class Graph:
    """The node graph as seen from one participant; may be used from any thread.

    Args:
        participant: which one.

    Attributes:
        changes: what the executor waits on for :meth:`listen`.
    """

    def __init__(self, participant: DomainParticipant) -> None:
        self._lock = lock
        self._participant = participant
        self._local: list[NodeEntitiesInfo] = []
        self._remote: dict[bytes, list[NodeEntitiesInfo]] = {}
        self._payload = payload_type(ParticipantEntitiesInfo)
        topic = Topic(participant, "ros_discovery_info", self._payload)
        self._writer = DataWriter(participant, topic, _WRITER_QOS)
        self._reader = DataReader(participant, topic, _READER_QOS)
        self.changes = ReadCondition(self._reader, ViewState.Any | SampleState.Any | InstanceState.Any)

    def add_node(self, namespace: str, name: str) -> NodeEntitiesInfo:
        """Announce a node of this process; what is returned stands for it in the other methods."""
        node = NodeEntitiesInfo(node_namespace=namespace, node_name=name)
        with self._lock:
            self._local.append(node)
            self._announce()
        return node

    def remove_node(self, node: NodeEntitiesInfo) -> None:
        """Announce that a node is gone."""
        with self._lock:
            self._local = [other for other in self._local if other is not node]
            self._announce()

    def set_endpoints(self, node: NodeEntitiesInfo, writers: list[bytes], readers: list[bytes]) -> None:
        """Announce which writers and readers are a node's, by their identifiers."""
        with self._lock:
            node.writer_gid_seq = [gid_of(guid) for guid in writers]
            node.reader_gid_seq = [gid_of(guid) for guid in readers]
            self._announce()

    def nodes(self) -> list[NodeEntitiesInfo]:
        """Return all nodes there are, those of this process first."""
        with self._lock:
            self.listen()
            return [*self._local, *(node for nodes in self._remote.values() for node in nodes)]

    def listen(self) -> None:
        """Take in what the others have announced, and forget those that are gone: a killed process says no goodbye.

        The executor calls it now and then, or announcements would pile up in a program that never asks.
        """
        with self._lock:
            while samples := self._reader.take(64):
                for sample in samples:
                    if sample.sample_info.valid_data:
                        self._learn(sample.data)
            alive = {participant.key.bytes for participant in _listed(self._participant, BuiltinTopicDcpsParticipant)}
            self._remote = {gid: nodes for gid, nodes in self._remote.items() if gid in alive}

    def publishers(self, wire_topic: str | None = None) -> list[Endpoint]:
        """Return the writers on a topic, or on all."""
        return self._endpoints(BuiltinTopicDcpsPublication, wire_topic)

    def subscriptions(self, wire_topic: str | None = None) -> list[Endpoint]:
        """Return the readers on a topic, or on all."""
        return self._endpoints(BuiltinTopicDcpsSubscription, wire_topic)

    def owner(self, endpoint: Endpoint) -> NodeEntitiesInfo | None:
        """Return the node that an endpoint belongs to, None if nobody says."""
        gid = endpoint.key.bytes
        return next((node for node in self.nodes() if gid in gids_of(node)), None)

    def _endpoints(self, listing: Any, wire_topic: str | None) -> list[Endpoint]:
        endpoints = _listed(self._participant, listing)
        return [endpoint for endpoint in endpoints if wire_topic in (None, endpoint.topic_name)]

    def _announce(self) -> None:
        with suppress(DDSException):  # shut down at this moment: there is nobody to tell
            gid = gid_of(self._participant.guid.bytes)
            info = ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=self._local)
            self._writer.write(self._payload(encode(info)))

    def _learn(self, data: bytes) -> None:
        try:
            info: ParticipantEntitiesInfo = decode(data, ParticipantEntitiesInfo)
        except RCLError:
            return
        self._remote[info.gid.data.tobytes()] = list(info.node_entities_info_seq)


def _listed(participant: DomainParticipant, topic: Any) -> list[Any]:
    """Return what Cyclone DDS lists on one of its built-in topics.

    The reader lives only as long as the call, because what is gone would pile up in it. One call at a time in the whole
    process, also because cyclonedds keeps the policies that it is converting in variables of a class.
    """
    with lock:
        reader = BuiltinDataReader(participant, topic)
        try:
            alive = ReadCondition(reader, ViewState.Any | SampleState.Any | InstanceState.Alive)
            entries: list[Any] = reader.read(MANY, alive)
            return entries
        finally:
            close(reader)


def gids_of(node: NodeEntitiesInfo) -> Iterator[bytes]:
    """Return the DDS identifiers of a node's writers and readers."""
    for gid in (*node.writer_gid_seq, *node.reader_gid_seq):
        yield gid.data.tobytes()
