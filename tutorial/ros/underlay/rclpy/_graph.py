"""Who is there: nodes, and the publishers and subscriptions on topics.

DDS knows participants, writers and readers, not nodes. In ROS 2 every participant tells on the topic
``ros_discovery_info`` which nodes it holds and which endpoints are whose; the whole list again at each change.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from cyclonedds import builtin
from cyclonedds.core import DDSException, InstanceState, ReadCondition, SampleState, ViewState
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import close, lock
from rclpy._endpoint_qos import FOREVER, type_hash_policy
from rclpy._rclpy_pybind11 import RCLError
from rclpy._wire import decode, encode, payload_type
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

if TYPE_CHECKING:
    from cyclonedds.domain import DomainParticipant

PUBLISHERS, SUBSCRIPTIONS = builtin.BuiltinTopicDcpsPublication, builtin.BuiltinTopicDcpsSubscription
MANY = 4096
"""More endpoints than are ever read at once."""

DiscoveredEndpoint = Any
"""A discovered writer or reader: ``cyclonedds.builtin.DcpsEndpoint``."""

_RELIABLE, _KEPT = Policy.Reliability.Reliable(FOREVER), Policy.Durability.TransientLocal
_BOTH_SIDES = (type_hash_policy(ParticipantEntitiesInfo), _RELIABLE, _KEPT)
_WRITER_QOS = Qos(
    *_BOTH_SIDES,
    Policy.History.KeepLast(1),
    Policy.DurabilityService(0, Policy.History.KeepLast(1), -1, -1, -1),
    Policy.WriterDataLifecycle(autodispose=False),
)
_READER_QOS = Qos(*_BOTH_SIDES, Policy.History.KeepAll, Policy.IgnoreLocal.Participant)


class Graph:
    """The node graph as seen from one participant; may be used from any thread.

    Args:
        participant: which one.

    Attributes:
        participant: that one.
        changes: what the executor waits on for :meth:`listen`.
    """

    def __init__(self, participant: DomainParticipant) -> None:
        self.participant = participant
        self._local: list[NodeEntitiesInfo] = []
        self._remote: dict[bytes, list[NodeEntitiesInfo]] = {}
        self._payload = payload_type(ParticipantEntitiesInfo._definition.type_name)
        topic = Topic(participant, "ros_discovery_info", self._payload)
        self._writer = DataWriter(participant, topic, _WRITER_QOS)
        self._reader = DataReader(participant, topic, _READER_QOS)
        self.changes = ReadCondition(self._reader, ViewState.Any | SampleState.Any | InstanceState.Any)

    def add_node(self, namespace: str, name: str) -> NodeEntitiesInfo:
        """Announce a node of this process; what is returned stands for it in the other methods."""
        node = NodeEntitiesInfo(node_namespace=namespace, node_name=name)
        with lock:
            self._local.append(node)
            self._announce()
        return node

    def remove_node(self, node: NodeEntitiesInfo) -> None:
        """Announce that a node is gone."""
        with lock:
            self._local = [other for other in self._local if other is not node]
            self._announce()

    def set_endpoints(self, node: NodeEntitiesInfo, writers: Iterable[bytes], readers: Iterable[bytes]) -> None:
        """Announce which writers and readers are a node's, by their identifiers."""
        with lock:
            node.writer_gid_seq = [Gid(data=list(guid)) for guid in writers]
            node.reader_gid_seq = [Gid(data=list(guid)) for guid in readers]
            self._announce()

    def nodes(self) -> list[NodeEntitiesInfo]:
        """Return all nodes there are, those of this process first."""
        with lock:
            self.listen()
            return [*self._local, *(node for nodes in self._remote.values() for node in nodes)]

    def owners(self) -> dict[bytes, NodeEntitiesInfo]:
        """Return the nodes by the identifiers of their writers and readers."""
        return {
            gid.data.tobytes(): node for node in self.nodes() for gid in (*node.writer_gid_seq, *node.reader_gid_seq)
        }

    def listen(self) -> None:
        """Take in what the others have announced, and forget those that are gone: a killed process says no goodbye.

        The executor calls it now and then, or announcements would pile up in a program that never asks.
        """
        with lock:
            while samples := self._reader.take(64):
                for sample in samples:
                    if sample.sample_info.valid_data:
                        self._learn(sample.data)
            alive = {participant.key.bytes for participant in self._listed(builtin.BuiltinTopicDcpsParticipant)}
            self._remote = {gid: nodes for gid, nodes in self._remote.items() if gid in alive}

    def endpoints(self, kind: Any, wire_topic: str | None = None) -> list[DiscoveredEndpoint]:
        """Return the writers or readers on a topic, or on all.

        Args:
            kind: PUBLISHERS or SUBSCRIPTIONS.
            wire_topic: its name in DDS.
        """
        return [endpoint for endpoint in self._listed(kind) if wire_topic in (None, endpoint.topic_name)]

    def _announce(self) -> None:
        with suppress(DDSException):  # shut down at this moment: there is nobody to tell
            gid = Gid(data=list(self.participant.guid.bytes))
            info = encode(ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=self._local))
            self._writer.write(self._payload(info))

    def _learn(self, data: bytes) -> None:
        with suppress(RCLError):
            info: Any = decode(data, ParticipantEntitiesInfo)
            self._remote[info.gid.data.tobytes()] = list(info.node_entities_info_seq)

    def _listed(self, topic: Any) -> list[Any]:
        """Return what Cyclone DDS lists on one of its built-in topics.

        The reader lives only as long as the call, because what is gone would pile up in it. One call at a time in the
        whole process, also because cyclonedds keeps the policies that it is converting in variables of a class.
        """
        with lock:
            reader = builtin.BuiltinDataReader(self.participant, topic)
            try:
                alive = ReadCondition(reader, ViewState.Any | SampleState.Any | InstanceState.Alive)
                entries: list[Any] = reader.read(MANY, alive)
                return entries
            finally:
                close(reader)
