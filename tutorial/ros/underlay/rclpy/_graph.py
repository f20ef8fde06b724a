"""Who is there: nodes, and the publishers and subscriptions on topics.

DDS knows participants, writers and readers, not nodes. In ROS 2 every participant tells on the topic
``ros_discovery_info`` which nodes it holds and which endpoints are whose; the whole list again at each change.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Iterable, Iterator
from contextlib import suppress
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from cyclonedds import builtin
from cyclonedds.core import DDSException, InstanceState, ReadCondition, SampleState, ViewState
from cyclonedds.internal import DDS, dds_c_t
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos, _CQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import close, lock
from rclpy._endpoint_qos import FOREVER, type_hash_policy
from rclpy._rclpy_pybind11 import RCLError
from rclpy._wire import decode, encode, payload_type
from rclpy.logging import get_logger
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

if TYPE_CHECKING:
    from cyclonedds.domain import DomainParticipant

PUBLISHERS, SUBSCRIPTIONS = builtin.BuiltinTopicDcpsPublication, builtin.BuiltinTopicDcpsSubscription
MANY = 4096
"""More endpoints than are ever read at once."""
AT_ONCE = 256
"""How many announcements are taken at once, so that taking them has an end where they keep coming."""
LONGEST = 65_536
"""The longest announcement that is read [bytes]: some 200 nodes in one process, with all that they publish. That takes
some 30 ms, and nobody who asks for nodes waits for more than about two of them."""

DiscoveredEndpoint = Any
"""A discovered writer or reader: its ``guid``, ``topic_name``, ``type_name``, and ``qos`` where that was asked for."""


class _Entry(ctypes.Structure):
    """Cyclone DDS's ``dds_builtintopic_endpoint_t``. What it lists of a participant begins with its guid, too."""

    _fields_ = (
        ("guid", ctypes.c_ubyte * 16),
        ("participant", ctypes.c_ubyte * 24),  # guid and handle
        ("topic_name", ctypes.c_char_p),
        ("type_name", ctypes.c_char_p),
        ("qos", dds_c_t.qos_p),
    )


_infos = (dds_c_t.sample_info * MANY)()  # where Cyclone DDS writes what nobody reads here
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
        self._unread: dict[bytes, bytes] = {}
        self._reading = threading.Lock()
        self._ignored = 0
        self._logger = get_logger("rclpy")
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
        self.listen()
        self._read()
        with lock:
            return [*self._local, *(node for nodes in self._remote.values() for node in nodes)]

    def owners(self) -> dict[bytes, NodeEntitiesInfo]:
        """Return the nodes by the identifiers of their writers and readers."""
        return {
            gid.data.tobytes(): node for node in self.nodes() for gid in (*node.writer_gid_seq, *node.reader_gid_seq)
        }

    def listen(self) -> None:
        """Take what the others have announced, and forget those that are gone: a killed process says no goodbye.

        The executor calls it now and then, or announcements would pile up in a program that never asks. They are read
        when somebody asks, and then only the newest of each participant.
        """
        with lock:
            for sample in self._reader.take(AT_ONCE):
                if sample.sample_info.valid_data:
                    self._unread[sample.data[4:20]] = sample.data  # its first field, behind the header, is the gid
            alive = {bytes(entry.guid) for entry in self._listed(builtin.BuiltinTopicDcpsParticipant)}
            self._remote = {gid: nodes for gid, nodes in self._remote.items() if gid in alive}
            self._unread = {gid: data for gid, data in self._unread.items() if gid in alive}

    def endpoints(self, kind: Any, wire_topic: str | None = None, *, full: bool = False) -> list[DiscoveredEndpoint]:
        """Return the writers or readers on a topic, or on all.

        Args:
            kind: PUBLISHERS or SUBSCRIPTIONS.
            wire_topic: its name in DDS.
            full: with their policies, which takes a tenth of a millisecond for each.
        """
        wanted = wire_topic and wire_topic.encode()
        return [_endpoint(entry, full) for entry in self._listed(kind) if wanted in (None, entry.topic_name)]

    def _announce(self) -> None:
        with suppress(DDSException):  # shut down at this moment: there is nobody to tell
            gid = Gid(data=list(self.participant.guid.bytes))
            info = encode(ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=self._local))
            self._writer.write(self._payload(info))

    def _read(self) -> None:
        """Read what was taken, in turn; beyond :data:`LONGEST` it waits for the next time."""
        left = LONGEST
        with self._reading:  # an older announcement must not come after a newer one
            while left > 0:
                with lock:
                    if not self._unread:
                        return
                    gid, data = next(iter(self._unread.items()))
                left -= len(data)
                nodes = self._remote.get(gid, [])
                try:
                    if len(data) > LONGEST:
                        raise RCLError(f"it has {len(data):,} bytes, at most {LONGEST:,} are read")
                    info: Any = decode(data, ParticipantEntitiesInfo)
                    nodes = list(info.node_entities_info_seq)
                except RCLError as error:
                    self._ignored += 1
                    text = f"{self._ignored} announcements of nodes have been ignored. The last: {error}"
                    self._logger.warning(text, throttle_duration_sec=10.0)
                with lock:
                    self._remote[gid] = nodes
                    if (newest := self._unread.pop(gid, data)) is not data:
                        self._unread[gid] = newest  # behind the others, which may have waited longer

    def _listed(self, topic: Any) -> Iterator[Any]:
        """Go through what Cyclone DDS lists on one of its built-in topics; what it lends is gone when this has ended.

        The reader lives only as long as the call, because what is gone would pile up in it. One call at a time in the
        whole process, also because cyclonedds keeps the policies that it is converting in variables of a class. Its
        own ``read`` converts the policies of all, whoever wants them, and makes of a Ctrl-C an error of its own.
        """
        entries = (ctypes.POINTER(_Entry) * MANY)()
        dds, count = DDS._dll_handle, 0
        with lock:
            reader = builtin.BuiltinDataReader(self.participant, topic)
            try:
                alive = ReadCondition(reader, ViewState.Any | SampleState.Any | InstanceState.Alive)
                count = dds.dds_read(alive._ref, entries, _infos, ctypes.c_size_t(MANY), ctypes.c_uint32(MANY))
                yield from (entry.contents for entry in entries[: max(count, 0)])
            finally:
                dds.dds_return_loan(reader._ref, entries, count)
                close(reader)


def _endpoint(entry: Any, full: bool) -> DiscoveredEndpoint:
    topic_name, type_name = (name.decode(errors="replace") for name in (entry.topic_name, entry.type_name))
    qos = _CQos.cqos_to_qos(entry.qos) if full else None
    return SimpleNamespace(guid=bytes(entry.guid), topic_name=topic_name, type_name=type_name, qos=qos)
