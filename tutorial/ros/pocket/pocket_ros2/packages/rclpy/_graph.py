"""Who is there: nodes, and the publishers and subscriptions on topics.

DDS knows participants, writers and readers, not nodes. In ROS 2 every participant tells on the topic
``ros_discovery_info`` which nodes it holds and which endpoints are whose; the whole list again at each change.
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
"""More endpoints than are ever read at once."""
AT_ONCE = 256
"""How many announcements are taken at once, so that taking them has an end where they keep coming."""
LONGEST = 32_768
"""The longest announcement that is read [bytes]: some 100 nodes in one process, with all that they publish. That takes
some 10 ms, or 40 where Python collects garbage meanwhile; whoever asks for nodes waits for two of them at most."""

Entry = TypeVar("Entry")
DiscoveredEndpoint = Any
"""A discovered writer or reader: its ``guid``, ``topic_name``, ``type_name``, and ``qos`` where that was asked for."""


TOPIC_NAME, TYPE_NAME, QOS = 5, 6, 7
"""Where Cyclone DDS's ``dds_builtintopic_endpoint_t`` has these pointers [words of 8 bytes], behind two guids and a
handle. What it lists of a participant begins with a guid, too, with these policies behind it."""
PARTICIPANT_QOS = 2
MADE_FOR = "11.0.1"
"""The version of the package cyclonedds in which these places were verified; the C API does not promise them."""

_announced = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_WRITER_QOS, _base = (to_dds(_announced, ParticipantEntitiesInfo, writer=writer) for writer in (True, False))
_READER_QOS = Qos(Policy.History.KeepAll, Policy.IgnoreLocal.Participant, base=_base)


class Graph:
    """The node graph as seen from one participant; may be used from any thread.

    Args:
        participant: which one.

    Attributes:
        participant: that one.
        changes: what the executor waits on for :meth:`listen`.

    Raises:
        RuntimeError: the package cyclonedds has another version than the verified one.
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
        """Return all nodes there are, those of this process first.

        Of what was announced no more than about :data:`LONGEST` is read at a time, in turn; the rest the next time.
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
        """Return the nodes by the identifiers of their writers and readers."""
        return {
            gid.data.tobytes(): node for node in self.nodes() for gid in (*node.writer_gid_seq, *node.reader_gid_seq)
        }

    def is_complete(self) -> bool:
        """Whether all ROS 2 programs that were discovered have told their nodes, and all that these have is there.

        Discovery finds the programs first. Fast DDS tells of its nodes at once, or seconds later.
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
        """Take what the others have announced, and forget those that are gone: a killed process says no goodbye.

        The executor calls it now and then, or announcements would pile up in a program that never asks. They are read
        when somebody asks, and then only the newest of each participant.
        """
        with lock:
            for sample in self._reader.take(AT_ONCE):
                if sample.sample_info.valid_data:
                    self._unread[sample.data[4:20]] = sample.data  # its first field, behind the header, is the gid
            alive = self._participants()
            self._remote = {gid: nodes for gid, nodes in self._remote.items() if gid in alive}
            self._unread = {gid: data for gid, data in self._unread.items() if gid in alive}

    def endpoints(self, kind: Any, wire_topic: str | None = None, *, full: bool = False) -> list[DiscoveredEndpoint]:
        """Return the writers or readers on a topic, or on all.

        Args:
            kind: PUBLISHERS or SUBSCRIPTIONS.
            wire_topic: its name in DDS.
            full: with their policies, which takes a tenth of a millisecond for each.
        """

        def read(entry: Any) -> DiscoveredEndpoint | None:
            topic, type_name = (ctypes.string_at(entry[i]).decode(errors="replace") for i in (TOPIC_NAME, TYPE_NAME))
            if wire_topic not in (None, topic):
                return None
            qos = _CQos.cqos_to_qos(entry[QOS]) if full else None
            return SimpleNamespace(guid=_gid(entry), topic_name=topic, type_name=type_name, qos=qos)

        return [endpoint for endpoint in self._listed(kind, read) if endpoint]

    def _announce(self) -> None:
        with suppress(DDSException):  # shut down at this moment: there is nobody to tell
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
        """Return what ``read`` makes of each entry that Cyclone DDS lists on one of its built-in topics.

        Cyclone DDS only lends the entries, so ``read`` must not keep them. The reader lives only as long as the call,
        because endpoints that are gone would pile up in it. One call at a time in the whole process, also because
        cyclonedds keeps the policies that it is converting in variables of a class. Its own ``read`` converts the
        policies of all entries, and turns a Ctrl-C into an error of its own.
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
    from importlib.metadata import version  # noqa: PLC0415 - it takes 10 ms, which `import rclpy` need not

    found = version("cyclonedds")
    if found != MADE_FOR:
        raise RuntimeError(
            f"the pocket ROS 2 reads structures of cyclonedds {MADE_FOR}, which may differ in the installed version, "
            f"{found}. Install the version that it was verified with: pip install cyclonedds=={MADE_FOR}"
        )


def _gid(entry: Any) -> bytes:
    """Return the identifier with which every listed entry begins."""
    return ctypes.string_at(entry, 16)


def _is_ros(entry: Any) -> bool:
    """Whether a listed participant names its enclave, as all of ROS 2 do."""
    qos = _CQos.cqos_to_qos(entry[PARTICIPANT_QOS])
    return Policy.Userdata in qos and b"enclave=" in qos[Policy.Userdata].data
