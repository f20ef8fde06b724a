"""The node graph: nodes, and the publishers and subscriptions on topics.

DDS knows participants, writers and readers, not nodes. In ROS 2 every participant publishes its nodes and their
endpoints on the topic ``ros_discovery_info``, and repeats the whole list on each change.
"""

import ctypes
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import cache
from types import SimpleNamespace
from typing import Any, TypeVar

from cyclonedds import builtin
from cyclonedds.core import DDSException, InstanceState, ReadCondition, SampleState, ViewState
from cyclonedds.domain import DomainParticipant
from cyclonedds.internal import DDS, dds_c_t
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos, _CQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import close, lock
from rclpy._endpoint_qos import to_dds
from rclpy._rclpy_pybind11 import RCLError
from rclpy._wire import decode, encode, payload_type
from rclpy.logging import get_logger
from rclpy.qos import DurabilityPolicy, QoSProfile
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

PUBLISHERS, SUBSCRIPTIONS = builtin.BuiltinTopicDcpsPublication, builtin.BuiltinTopicDcpsSubscription
MANY = 4096
"""Maximum number of endpoints in one read; there are never that many."""
AT_ONCE = 256
"""Maximum number of announcements to take at once, so that a constant stream of them cannot block the caller."""
LONGEST = 32_768
"""Maximum size of an announcement [bytes]: about 100 nodes in one process, with all their publishers. Decoding it takes
about 10 ms, or 40 during a garbage collection; a query for nodes decodes at most two of them."""

Entry = TypeVar("Entry")
DiscoveredEndpoint = Any
"""A discovered writer or reader: its ``guid``, ``topic_name``, ``type_name``, and ``qos`` if requested."""


TOPIC_NAME, TYPE_NAME, QOS = 5, 6, 7
"""Offsets of these pointers in Cyclone DDS's ``dds_builtintopic_endpoint_t`` [words of 8 bytes], after two guids and a
handle. An entry for a participant also begins with a guid, followed by these policies."""
PARTICIPANT_QOS = 2
MADE_FOR = "11.0.1"
"""The verified version of the package cyclonedds: its C API does not guarantee these offsets."""

_announced = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_WRITER_QOS, _base = (to_dds(_announced, ParticipantEntitiesInfo, writer=writer) for writer in (True, False))
_READER_QOS = Qos(Policy.History.KeepAll, Policy.IgnoreLocal.Participant, base=_base)


class Graph:
    """The node graph as seen from one participant; can be used from any thread.

    Args:
        participant: the participant.

    Attributes:
        participant: as given.
        changes: the condition that the executor waits for before it calls :meth:`listen`.

    Raises:
        RuntimeError: the installed version of cyclonedds is not the verified one.
    """

    def __init__(self, participant: DomainParticipant) -> None:
        _check_version()
        self.participant = participant
        self._local: list[NodeEntitiesInfo] = []
        self._remote: dict[bytes, list[NodeEntitiesInfo]] = {}
        self._unread: dict[bytes, bytes] = {}
        self._ignored = 0
        self._logger = get_logger("rclpy")
        self._payload = payload_type(ParticipantEntitiesInfo._definition.type_name)
        topic = Topic(participant, "ros_discovery_info", self._payload)
        self._writer = DataWriter(participant, topic, _WRITER_QOS)
        self._reader = DataReader(participant, topic, _READER_QOS)
        self.changes = ReadCondition(self._reader, ViewState.Any | SampleState.Any | InstanceState.Any)

    def add_node(self, namespace: str, name: str) -> NodeEntitiesInfo:
        """Announce a node of this process, and return the entry that stands for it in the other methods."""
        node = NodeEntitiesInfo(node_namespace=namespace, node_name=name)
        with lock:
            self._local.append(node)
            self._announce()
        return node

    def remove_node(self, node: NodeEntitiesInfo) -> None:
        """Announce that a node was removed."""
        with lock:
            self._local = [other for other in self._local if other is not node]
            self._announce()

    def set_endpoints(self, node: NodeEntitiesInfo, writers: Iterable[bytes], readers: Iterable[bytes]) -> None:
        """Announce a node's writers and readers, by their identifiers."""
        with lock:
            node.writer_gid_seq = [Gid(data=list(guid)) for guid in writers]
            node.reader_gid_seq = [Gid(data=list(guid)) for guid in readers]
            self._announce()

    def nodes(self) -> list[NodeEntitiesInfo]:
        """Return all known nodes, those of this process first.

        Each call decodes about :data:`LONGEST` bytes of announcements at most, and leaves the rest to the next one.
        """
        with lock:
            self.listen()
            left = LONGEST
            while left > 0 and self._unread:
                gid, data = next(iter(self._unread.items()))
                left -= len(data)
                self._learn(gid, data)
                del self._unread[gid]
            return [*self._local, *(node for nodes in self._remote.values() for node in nodes)]

    def owners(self) -> dict[bytes, NodeEntitiesInfo]:
        """Return nodes by the identifiers of their writers and readers."""
        return {
            gid.data.tobytes(): node for node in self.nodes() for gid in (*node.writer_gid_seq, *node.reader_gid_seq)
        }

    def is_complete(self) -> bool:
        """Return whether all discovered ROS 2 programs have announced their nodes, and all endpoints are discovered.

        Discovery finds the programs first. Fast DDS announces its nodes at once, or seconds later.
        """
        with lock:
            told = self.owners().keys() | {self.participant.guid.bytes, *self._remote}
            found = {endpoint.guid for kind in (PUBLISHERS, SUBSCRIPTIONS) for endpoint in self.endpoints(kind)}
            unknown = self._listed(
                builtin.BuiltinTopicDcpsParticipant, lambda entry: _gid(entry) not in told and _is_ros(entry)
            )
            found |= self._participants()
            return not self._unread and not any(unknown) and told <= found

    def listen(self) -> None:
        """Take new announcements, and drop participants that are gone: a killed process announces nothing.

        The executor calls this regularly, because announcements would pile up in a program that never queries the
        graph. Only a query decodes them, and only the newest one of each participant.
        """
        with lock:
            for sample in self._reader.take(AT_ONCE):
                if sample.sample_info.valid_data:
                    self._unread[sample.data[4:20]] = sample.data  # the gid is the first field, after the header
            alive = self._participants()
            self._remote = {gid: nodes for gid, nodes in self._remote.items() if gid in alive}
            self._unread = {gid: data for gid, data in self._unread.items() if gid in alive}

    def endpoints(self, kind: Any, wire_topic: str | None = None, *, full: bool = False) -> list[DiscoveredEndpoint]:
        """Return the writers or readers on one topic, or on all.

        Args:
            kind: PUBLISHERS or SUBSCRIPTIONS.
            wire_topic: the topic's name in DDS; None for all topics.
            full: include their policies, which takes 0.1 ms per endpoint.
        """

        def read(entry: Any) -> DiscoveredEndpoint | None:
            topic, type_name = (ctypes.string_at(entry[i]).decode(errors="replace") for i in (TOPIC_NAME, TYPE_NAME))
            if wire_topic not in (None, topic):
                return None
            qos = _CQos.cqos_to_qos(entry[QOS]) if full else None
            return SimpleNamespace(guid=_gid(entry), topic_name=topic, type_name=type_name, qos=qos)

        return [endpoint for endpoint in self._listed(kind, read) if endpoint]

    def _announce(self) -> None:
        with suppress(DDSException):  # the context is shutting down, so nobody needs to know
            gid = Gid(data=list(self.participant.guid.bytes))
            info = encode(ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=self._local))
            self._writer.write(self._payload(info))

    def _learn(self, gid: bytes, data: bytes) -> None:
        try:
            if len(data) > LONGEST:
                raise RCLError(f"it has {len(data):,} bytes, at most {LONGEST:,} are read")
            info: Any = decode(data, ParticipantEntitiesInfo)
            self._remote[gid] = list(info.node_entities_info_seq)
        except RCLError as error:
            self._ignored += 1
            self._remote.setdefault(gid, [])
            text = f"{self._ignored} announcements of nodes have been ignored. The last: {error}"
            self._logger.warning(text, throttle_duration_sec=10.0)

    def _participants(self) -> set[bytes]:
        """Return the identifiers of all participants that are alive."""
        return set(self._listed(builtin.BuiltinTopicDcpsParticipant, _gid))

    def _listed(self, topic: Any, read: Callable[[Any], Entry]) -> list[Entry]:
        """Return the result of ``read`` for each entry on one of Cyclone DDS's built-in topics.

        Cyclone DDS only lends the entries, so ``read`` must not keep them. The reader lives only during the call,
        because endpoints that are gone would pile up in it. The lock allows one call at a time in the whole process,
        also because cyclonedds stores the policies that it is converting in class variables. Its own ``read`` would
        convert the policies of all entries, and replace Ctrl-C with an exception of its own.
        """
        entries = (ctypes.POINTER(ctypes.c_void_p) * MANY)()
        dds, count, infos = DDS._dll_handle, 0, (dds_c_t.sample_info * MANY)()
        with lock:
            reader = builtin.BuiltinDataReader(self.participant, topic)
            try:
                alive = ReadCondition(reader, ViewState.Any | SampleState.Any | InstanceState.Alive)
                count = dds.dds_read(alive._ref, entries, infos, ctypes.c_size_t(MANY), ctypes.c_uint32(MANY))
                return [read(entry) for entry in entries[: max(count, 0)]]
            finally:
                dds.dds_return_loan(reader._ref, entries, count)
                close(reader)


@cache
def _check_version() -> None:
    from importlib.metadata import version  # noqa: PLC0415 - it takes 10 ms, which `import rclpy` can save

    found = version("cyclonedds")
    if found != MADE_FOR:
        raise RuntimeError(
            f"the pocket ROS 2 reads structures of cyclonedds {MADE_FOR}, which may differ in the installed version, "
            f"{found}. Install the version that it was verified with: pip install cyclonedds=={MADE_FOR}"
        )


def _gid(entry: Any) -> bytes:
    """Return the identifier at the start of a listed entry."""
    return ctypes.string_at(entry, 16)


def _is_ros(entry: Any) -> bool:
    """Return whether a listed participant names an enclave, as every ROS 2 participant does."""
    qos = _CQos.cqos_to_qos(entry[PARTICIPANT_QOS])
    return Policy.Userdata in qos and b"enclave=" in qos[Policy.Userdata].data
