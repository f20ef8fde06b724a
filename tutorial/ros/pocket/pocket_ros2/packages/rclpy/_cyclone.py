"""The middleware: an implementation of `rclpy._transport` based on Cyclone DDS."""

import ctypes
import os
import re
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, ClassVar, Self, TypeVar

import msgspec
from _rosidl.definitions import type_hash
from cyclonedds import builtin, core
from cyclonedds.core import DDSException as TransportError
from cyclonedds.core import InstanceState, SampleState, ViewState
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import types
from cyclonedds.internal import DDS, SampleInfo, dds_c_t
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos, _CQos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from rclpy._domain import configuration, likely_cause, lock
from rclpy._endpoint_qos import explicit
from rclpy._rclpy_pybind11 import RCLError
from rclpy._transport import PUBLISHERS, EndpointInfo, NodeInfo
from rclpy._wire import decode, encode, wire_type
from rclpy.duration import Duration, Infinite
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointTypeEnum
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

__all__ = ["TransportError", "decode_nodes", "encode_nodes", "join"]

Entry = TypeVar("Entry")

FATAL_AND_ERROR = 3
"""Kinds of messages that Cyclone DDS is allowed to print. Warnings are excluded, because Cyclone DDS warns about each
malformed packet, and its configuration cannot turn these warnings off. Warnings about the configuration itself are
printed before this setting takes effect."""
UNLIMITED = -1
INCOMPATIBLE = {2: "DURABILITY", 4: "DEADLINE", 8: "LIVELINESS", 11: "RELIABILITY", 24: "TYPE"}
"""DDS's numbers for the reasons why a writer and a reader are incompatible: a policy, or their message types."""
MANY = 4096
"""Maximum number of entries in one read; in practice, there are never that many."""

TOPIC_NAME, TYPE_NAME, QOS = 5, 6, 7
"""Offsets of these pointers in Cyclone DDS's ``dds_builtintopic_endpoint_t`` [words of 8 bytes], after two guids and a
handle. In an entry for a participant, the pointer to the policies comes after one guid."""
PARTICIPANT_QOS = 2
MADE_FOR = "11.0.1"
"""The version of the package cyclonedds whose offsets we verified: its C API does not guarantee them."""

_domains: dict[int, Domain] = {}
_users: Counter[int] = Counter()

_forked = False
"""Whether this process was forked from one that took part in a domain."""


class Payload:
    """CDR bytes that pass into or out of Cyclone DDS, which handles this class like one of its structs.

    A received message is therefore decoded only when a thread needs it, on that thread, and a malformed message does
    not affect later messages.
    """

    __slots__ = ("data", "sample_info")

    __idl__: ClassVar[Any]
    __idl_typename__: ClassVar[str]
    sample_info: Any

    def __init__(self, data: bytes) -> None:
        self.data = data

    def serialize(self, use_version_2: bool | None = None) -> bytes:  # noqa: ARG002
        """Return the bytes for Cyclone DDS to send."""
        return self.data

    @classmethod
    def deserialize(cls, data: bytes) -> Self:
        """Wrap the bytes that Cyclone DDS has received."""
        return cls(data)

    deserialize_key = deserialize


SampleInfo.__new__ = staticmethod(msgspec.defstruct("SampleInfo", ["python_class", *SampleInfo.__match_args__]))
# Replaced by a constructor in C. Cyclone DDS's C code constructs an object for each sample, and crashes if the
# constructor raises an exception, as a constructor in Python does when Ctrl-C interrupts it.


@cache
def payload_type(type_name: str) -> type[Payload]:
    """Return the payload class for topics with a given message type, such as ``"sensor_msgs/msg/Joy"``."""
    made = wire_type(type_name, types.sequence[types.uint8])
    identity = {"__slots__": (), "__idl__": made.__idl__, "__idl_typename__": made.__idl_typename__}
    return type(f"{made.__name__}Payload", (Payload,), identity)


def to_dds(profile: QoSProfile, type_name: str, *, writer: bool) -> Qos:
    """Return the DDS policies of a writer or reader.

    Args:
        profile: the requested QoS.
        type_name: the message type, whose hash is announced with the endpoint.
        writer: whether the policies are for a writer.

    Raises:
        TypeError: the depth is negative.
    """
    profile = explicit(profile, writer=writer)
    keep_all = profile.history == HistoryPolicy.KEEP_ALL
    history = Policy.History.KeepAll if keep_all else Policy.History.KeepLast(profile.depth)
    reliable = profile.reliability == ReliabilityPolicy.RELIABLE
    kept = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    manual = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    liveliness = Policy.Liveliness.ManualByTopic if manual else Policy.Liveliness.Automatic
    policies = [
        Policy.Userdata(f"typehash={type_hash(type_name)};".encode()),  # ROS 2 warns if the hash is missing
        history,
        Policy.Reliability.Reliable(Infinite.nanoseconds) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if kept else Policy.Durability.Volatile,
        Policy.Deadline(profile.deadline.nanoseconds),
        liveliness(profile.liveliness_lease_duration.nanoseconds),
    ]
    if kept:
        policies.append(Policy.DurabilityService(0, history, UNLIMITED, UNLIMITED, UNLIMITED))
    if writer:
        policies += [Policy.Lifespan(profile.lifespan.nanoseconds), Policy.WriterDataLifecycle(autodispose=False)]
    return Qos(*policies)


def from_dds(qos: Qos) -> QoSProfile:
    """Return the profile of a discovered endpoint."""
    history, liveliness = qos[Policy.History], qos[Policy.Liveliness]
    last = isinstance(history, Policy.History.KeepLast)
    reliable = isinstance(qos[Policy.Reliability], Policy.Reliability.Reliable)
    volatile = qos[Policy.Durability] == Policy.Durability.Volatile
    manual = isinstance(liveliness, Policy.Liveliness.ManualByTopic)
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST if last else HistoryPolicy.KEEP_ALL,
        depth=history.depth if last else 0,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE if volatile else DurabilityPolicy.TRANSIENT_LOCAL,
        lifespan=Duration(nanoseconds=qos[Policy.Lifespan].lifespan) if Policy.Lifespan in qos else Infinite,
        deadline=Duration(nanoseconds=qos[Policy.Deadline].deadline) if Policy.Deadline in qos else Infinite,
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC if manual else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(nanoseconds=liveliness.lease_duration) if liveliness else Infinite,
    )


class _Endpoint:
    """The common base class of writers and readers; implements `rclpy._transport.Entity`."""

    _kind: type[DataWriter[Any] | DataReader[Any]]
    _incompatible: int
    """The Cyclone DDS status that reports an incompatible partner."""
    _get_incompatible: str
    """Name of the method that returns details about this status."""
    _get_matched: str
    """Name of the method that returns the number of partners."""

    def __init__(self, participant: DomainParticipant, topic_name: str, type_name: str, qos: Qos) -> None:
        with lock:
            self._payload = payload_type(type_name)
            self._topic = Topic(participant, topic_name, self._payload)
            self.dds: Any = self._kind(participant, self._topic, qos)
            self.dds.set_status_mask(self._incompatible)
        self.guid: bytes = self.dds.guid.bytes

    def count_matched(self) -> int:
        return int(getattr(self.dds, self._get_matched)().current_count)

    def take_incompatible(self) -> str:
        if not self.dds.take_status(self._incompatible):
            return ""
        return INCOMPATIBLE.get(getattr(self.dds, self._get_incompatible)().last_policy_id, "INVALID")

    def close(self) -> None:
        close(self.dds)
        close(self._topic)


class Writer(_Endpoint):
    """Implements `rclpy._transport.Writer`."""

    _kind = DataWriter
    _incompatible = core.DDSStatus.OfferedIncompatibleQos
    _get_incompatible = "get_offered_incompatible_qos_status"
    _get_matched = "get_publication_matched_status"

    def write(self, data: bytes) -> None:
        self.dds.write(self._payload(data))

    def wait_for_acks(self, timeout_ns: int) -> bool:
        try:
            return bool(self.dds.wait_for_acks(timeout_ns))
        except AttributeError:  # raised by cyclonedds 11.0.1 on a timeout
            return False


class Reader(_Endpoint):
    """Implements `rclpy._transport.Reader`."""

    _kind = DataReader
    _incompatible = core.DDSStatus.RequestedIncompatibleQos
    _get_incompatible = "get_requested_incompatible_qos_status"
    _get_matched = "get_subscription_matched_status"

    def __init__(self, participant: DomainParticipant, topic_name: str, type_name: str, qos: Qos) -> None:
        with lock:
            super().__init__(participant, topic_name, type_name, qos)
            self.messages = core.ReadCondition(self.dds, ViewState.Any | InstanceState.Any | SampleState.Any)

    def take(self) -> tuple[bytes, int] | None:
        while samples := self.dds.take(1):
            if samples[0].sample_info.valid_data:
                return samples[0].data, samples[0].sample_info.source_timestamp
        return None


class Waiter:
    """Implements `rclpy._transport.Waiter`.

    It calls C functions directly, because the wait set in Cyclone DDS's Python package does not report which entities
    are ready.
    """

    def __init__(self, participant: DomainParticipant) -> None:
        self._participant = participant
        self._wait_set: core.WaitSet | None = None
        self._owners: list[Any] = []
        with lock:
            self._guard = core.GuardCondition(participant)

    def watch(self, endpoints: Sequence[tuple[Any, Any]]) -> None:
        self._close_wait_set()  # a new wait set is needed because other threads add and delete entities
        sources = [(self._guard, None)]
        for endpoint, owner in endpoints:
            sources.append((endpoint.dds, None))
            if isinstance(endpoint, Reader):
                sources.append((endpoint.messages, owner))
        self._owners = [owner for _, owner in sources]
        with lock:
            wait_set = self._wait_set = core.WaitSet(self._participant)
        # This fails if a source has just been destroyed, but its destruction wakes the executor again.
        for key, (source, _) in enumerate(sources):
            wait_set._waitset_attach(wait_set._ref, source._ref, key)

    def wait(self, timeout: float) -> list[Any]:
        if self._wait_set is None:
            return []
        keys = (dds_c_t.attach * len(self._owners))()
        count = self._wait_set._waitset_wait(self._wait_set._ref, keys, len(keys), int(timeout * 1e9))
        if count < 0:
            raise TransportError(count, "Occurred while waiting")
        ready = [self._owners[key] for key in sorted(key or 0 for key in keys[:count])]
        if None in ready:
            self._guard.take()
        return ready

    def wake(self) -> None:
        self._guard.set(True)

    def close(self) -> None:
        self._close_wait_set()
        close(self._guard)

    def _close_wait_set(self) -> None:
        wait_set, self._wait_set = self._wait_set, None
        if wait_set is not None:
            close(wait_set)


class Participant:
    """Implements `rclpy._transport.Participant`; created by :func:`join`."""

    def __init__(self, domain_id: int) -> None:
        self._domain_id = domain_id
        self.dds = DomainParticipant(domain_id, Qos(Policy.Userdata(b"enclave=/;")))
        self.guid: bytes = self.dds.guid.bytes

    def create_writer(self, topic_name: str, type_name: str, profile: QoSProfile) -> Writer:
        return Writer(self.dds, topic_name, type_name, to_dds(profile, type_name, writer=True))

    def create_reader(
        self, topic_name: str, type_name: str, profile: QoSProfile, *, ignore_own: bool = False
    ) -> Reader:
        qos = to_dds(profile, type_name, writer=False)
        if ignore_own:
            qos = Qos(Policy.IgnoreLocal.Participant, base=qos)
        return Reader(self.dds, topic_name, type_name, qos)

    def create_waiter(self) -> Waiter:
        return Waiter(self.dds)

    def participants(self, *, only_ros: bool = False) -> set[bytes]:
        def read(entry: Any) -> bytes | None:
            is_wanted = not only_ros or b"enclave=" in _userdata(_CQos.cqos_to_qos(entry[PARTICIPANT_QOS]))
            return _guid(entry) if is_wanted else None

        return {*filter(None, self._listed(builtin.BuiltinTopicDcpsParticipant, read))}

    def endpoints(
        self, kind: TopicEndpointTypeEnum, topic_name: str | None = None, *, full: bool = False
    ) -> list[EndpointInfo]:
        def read(entry: Any) -> EndpointInfo | None:
            topic, type_name = (ctypes.string_at(entry[i]).decode(errors="replace") for i in (TOPIC_NAME, TYPE_NAME))
            if topic_name not in (None, topic):
                return None
            info = EndpointInfo(kind, _guid(entry), topic, type_name)
            if full:
                qos = _CQos.cqos_to_qos(entry[QOS])
                found = re.search(rb"typehash=(RIHS\d\d_[0-9a-f]{64});", _userdata(qos))
                info.type_hash, info.qos = found[1].decode() if found else "", from_dds(qos)
            return info

        is_writer = kind == PUBLISHERS
        topic = builtin.BuiltinTopicDcpsPublication if is_writer else builtin.BuiltinTopicDcpsSubscription
        return [*filter(None, self._listed(topic, read))]

    def leave(self) -> None:
        """Close the participant and its entities.

        If this process has no other participant in the domain, also free the domain's ports and threads.

        Don't delete the entities before the participant. Cyclone DDS's Python package frees a message type when the
        last topic of this type is deleted. However, a domain uses the type of its first message, an announcement of
        nodes, until the domain itself is deleted (``serdata_eqkey`` in its C code). A participant deletes its topics
        last.
        """
        with lock:
            close(self.dds)
            _users[self._domain_id] -= 1
            _close_if_unused(self._domain_id)

    def _listed(self, topic: Any, read: Callable[[Any], Entry]) -> list[Entry]:
        """Return the result of ``read`` for each entry on one of Cyclone DDS's built-in topics.

        Cyclone DDS only lends the entries, so ``read`` must not store them. The reader exists only during the call,
        because deleted endpoints would accumulate in a permanent reader. The lock allows one call at a time in the
        whole process, partly because cyclonedds uses class variables while it converts policies. The package's own
        ``read`` would convert the policies of all entries, and turn a KeyboardInterrupt into a different exception.
        """
        entries = (ctypes.POINTER(ctypes.c_void_p) * MANY)()
        dds, count, infos = DDS._dll_handle, 0, (dds_c_t.sample_info * MANY)()
        with lock:
            reader = builtin.BuiltinDataReader(self.dds, topic)
            try:
                alive = core.ReadCondition(reader, ViewState.Any | SampleState.Any | InstanceState.Alive)
                count = dds.dds_read(alive._ref, entries, infos, ctypes.c_size_t(MANY), ctypes.c_uint32(MANY))
                return [read(entry) for entry in entries[: max(count, 0)]]
            finally:
                dds.dds_return_loan(reader._ref, entries, count)
                close(reader)


def join(domain_id: int) -> Participant:
    """Join a domain. All of this process's participants in the domain share the configuration and the ports.

    Raises:
        RCLError: too many processes on this machine have joined the domain, the loopback interface is down, Cyclone DDS
            cannot start, or this process was forked from a process that had joined a domain.
        RuntimeError: the installed version of cyclonedds is not the one that this module was verified with.
    """
    _check_version()
    if _forked:
        raise RCLError(
            "failed to create a participant: this process was created by os.fork() from a process that has nodes. "
            "Start it with subprocess, or with multiprocessing's start method 'spawn'."
        )
    with lock:
        try:
            if domain_id not in _domains:
                _domains[domain_id] = Domain(domain_id, configuration())
                DDS._dll_handle.dds_set_log_mask(FATAL_AND_ERROR)
            participant = Participant(domain_id)
        except TransportError as error:
            _close_if_unused(domain_id)
            raise RCLError(f"failed to create a participant in domain {domain_id}: {likely_cause(error)}") from error
        _users[domain_id] += 1
        return participant


def encode_nodes(guid: bytes, nodes: Sequence[NodeInfo]) -> bytes:
    """Serialize a participant's announcement of its nodes."""
    entries = [
        NodeEntitiesInfo(
            node_namespace=node.node_namespace,
            node_name=node.node_name,
            writer_gid_seq=_gids(node.writers),
            reader_gid_seq=_gids(node.readers),
        )
        for node in nodes
    ]
    return encode(ParticipantEntitiesInfo(gid=_gids([guid])[0], node_entities_info_seq=entries))


def decode_nodes(data: bytes) -> list[NodeInfo]:
    """Deserialize an announcement.

    Raises:
        RCLError: the bytes are not an announcement.
    """
    info: Any = decode(data, ParticipantEntitiesInfo)
    return [
        NodeInfo(node.node_namespace, node.node_name, _guids(node.writer_gid_seq), _guids(node.reader_gid_seq))
        for node in info.node_entities_info_seq
    ]


def _gids(guids: Sequence[bytes]) -> list[Gid]:
    return [Gid(data=list(guid)) for guid in guids]


def _guids(gids: Sequence[Gid]) -> list[bytes]:
    return [gid.data.tobytes() for gid in gids]


def close(entity: core.Entity) -> None:
    """Delete an entity now.

    Cyclone DDS's Python objects delete the entity in their finalizer, which can safely run early and more than once.
    Without this call, the finalizer would not run until the last reference to the object was gone.
    """
    with lock:
        entity.__del__()


def _close_if_unused(domain_id: int) -> None:
    if not _users[domain_id] and (domain := _domains.pop(domain_id, None)):
        close(domain)


@cache
def _check_version() -> None:
    from importlib.metadata import version  # noqa: PLC0415 - it would slow `import rclpy` down by 10 ms

    found = version("cyclonedds")
    if found != MADE_FOR:
        raise RuntimeError(
            f"the pocket ROS 2 reads structures of cyclonedds {MADE_FOR}, which may differ in the installed version, "
            f"{found}. Install the verified version: pip install cyclonedds=={MADE_FOR}"
        )


def _guid(entry: Any) -> bytes:
    """Return the identifier at the start of a listed entry."""
    return ctypes.string_at(entry, 16)


def _userdata(qos: Qos) -> bytes:
    """Return the user data: the enclave of a participant, or the hash of an endpoint's message type."""
    return bytes(qos[Policy.Userdata].data) if Policy.Userdata in qos else b""


def _forget() -> None:
    """Drop all DDS entities in a newly forked process. Don't call DDS: it would wait for threads that don't exist."""
    global _forked  # noqa: PLW0603
    _forked = _forked or bool(_domains)
    for entity in list(core.Entity._entities.values()):
        entity._ref = 0  # refers to no entity: every call fails, and the finalizer does nothing
    core.Entity._entities.clear()
    _domains.clear()
    _users.clear()


os.register_at_fork(after_in_child=_forget)
