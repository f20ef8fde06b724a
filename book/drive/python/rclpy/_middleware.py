"""Replace Cyclone DDS in the browser: carry messages between the programs of one page.

This module implements `rclpy._transport`. A published message reaches the readers in the same program
at once, as CDR bytes, and `Wire` passes it on to the page's other programs. No message leaves the page.
"""

import pickle
import threading
import time
import uuid
from collections import defaultdict, deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from _rosidl.definitions import type_hash
from rclpy._endpoint_qos import explicit
from rclpy._transport import PUBLISHERS, SUBSCRIPTIONS, EndpointInfo, NodeInfo
from rclpy._wire import wire_name
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointTypeEnum

FITS = ""

changed = threading.Condition(threading.RLock())
"""Held while endpoints or messages are added or removed, and notified afterwards."""


class TransportError(Exception):
    """The middleware's error. Nothing in the page raises it."""


@dataclass
class Info(EndpointInfo):
    """A writer or reader, as other programs know it.

    Attributes:
        owner: the participant's identifier.
        kept: the messages that a writer keeps for late readers.
    """

    owner: bytes = b""
    kept: deque[bytes] = field(default_factory=lambda: deque(maxlen=0))


class Wire:
    """The publishers and subscriptions in a domain: in this program, and in the page's other programs.

    Attributes:
        participants: this program's participants.
        others: the endpoints that each of the other programs has announced.
        send: called with the topic, its type, the writer's identifier and the bytes for the other programs.
        announce: called with bytes for the other programs' `hear`.
    """

    def __init__(self) -> None:
        self.participants: list[Participant] = []
        self.others: dict[str, list[Info]] = {}
        self.send = self.announce = lambda *_: None

    def own_endpoints(self) -> list[Any]:
        """Return the endpoints of this program."""
        return [each for participant in self.participants for each in participant.own]

    def endpoints(self) -> list[Info]:
        """Describe the endpoints of all programs, starting with this one's."""
        return sum(self.others.values(), [each.info for each in self.own_endpoints()])

    def hear(self, program: str, described: Any) -> None:
        """Store an announcement from another program's `tell`."""
        self.others[program] = pickle.loads(described)
        self._compare()

    def tell(self) -> None:
        """Announce this program's endpoints after a change."""
        self._compare()
        self.announce(pickle.dumps([each.info for each in self.own_endpoints()]))

    def deliver(self, guid: str, data: Any) -> None:
        """Deliver a writer's message to this program's matching readers; the writer may be in a different program."""
        with changed:
            for each in self.own_endpoints():
                if each.partners.get(bytes.fromhex(guid)) == FITS:
                    each.put(data)
            changed.notify_all()

    def _compare(self) -> None:
        with changed:
            everyone = self.endpoints()
            for each in self.own_endpoints():
                each.compare(everyone)
            changed.notify_all()


wires: dict[int, Wire] = defaultdict(Wire)
"""The wire of each domain, by its number."""


class Endpoint:
    """Base class of writers and readers.

    Attributes:
        info: its description for other programs.
        partners: maps each endpoint at the other end of its topic, by identifier, to the reason why the two don't
            match, or to `FITS`.
        has_misfit: whether a partner that does not match has appeared.
        samples: received messages that have not been taken.
    """

    def __init__(
        self, participant: "Participant", kind: Any, topic: str, type_name: str, qos: QoSProfile, ignored: bytes = b""
    ) -> None:
        qos = explicit(qos, writer=kind == PUBLISHERS)
        self._participant, self.guid, depth = participant, uuid.uuid4().bytes, qos.depth or None  # 0 of "keep all"
        self.info = Info(kind, self.guid, topic, wire_name(type_name), type_hash(type_name), qos, participant.guid)
        self.info.kept = deque(maxlen=depth if _is_kept(qos) else 0)
        self.partners, self._last_misfit, self.has_misfit = dict[bytes, str](), FITS, False
        self._ignored, self.samples = ignored, deque[Any](maxlen=depth)
        with changed:
            participant.own.append(self)
        participant.wire.tell()

    def close(self) -> None:
        """Leave the domain."""
        if self in self._participant.own:
            self._participant.own.remove(self)
            self._participant.wire.tell()

    def compare(self, everyone: list[Info]) -> None:
        """Find its partners among all endpoints. Record new misfits, and receive the messages kept by new partners."""
        known, self.partners = self.partners, {}
        for each in everyone:
            if each.topic_name == self.info.topic_name and each.kind != self.info.kind and each.owner != self._ignored:
                misfit = self.partners[each.guid] = _misfit(self.info, each)
                if misfit and each.guid not in known:
                    self._last_misfit, self.has_misfit = misfit, True
                elif each.guid not in known and _is_kept(self.info.qos):
                    for data in each.kept:
                        self.put(data)

    def put(self, data: Any) -> None:
        """Store a published message."""
        self.samples.append((bytes(data), time.time_ns()))

    def take_incompatible(self) -> str:
        """Return what makes the last misfit incompatible, or "" if none has appeared since the last call."""
        unsaid, self.has_misfit = self.has_misfit, False
        return self._last_misfit if unsaid else ""

    def count_matched(self) -> int:
        """Return the number of matching partners."""
        return [*self.partners.values()].count(FITS)

    def write(self, data: bytes) -> None:
        """Send a message to the matching readers."""
        self.info.kept.append(data)
        self._participant.wire.deliver(self.guid.hex(), data)
        self._participant.wire.send(self.info.topic_name, self.info.type_name, self.guid.hex(), data)

    def wait_for_acks(self, _timeout_ns: int) -> bool:
        """Return True: readers receive every message at once."""
        return True

    def take(self) -> Any:
        """Remove and return the next message, and when it was sent [ns], or None."""
        with changed:
            return self.samples.popleft() if self.samples else None


class Waiter:
    """Waits for messages and events."""

    def __init__(self) -> None:
        self._watched: Sequence[tuple[Endpoint, Any]] = ()
        self._is_woken = False

    def watch(self, endpoints: Sequence[tuple[Endpoint, Any]]) -> None:
        self._watched = endpoints

    def wait(self, timeout: float) -> list[Any]:
        with changed:
            ready = changed.wait_for(self._ready, timeout)
            self._is_woken = False
            return ready

    def wake(self) -> None:
        with changed:
            self._is_woken = True
            changed.notify_all()

    def close(self) -> None:
        """Do nothing: there is nothing to release."""

    def _ready(self) -> list[Any]:
        is_woken = self._is_woken or any(each.has_misfit for each, _ in self._watched)
        return [*([None] if is_woken else []), *(owner for each, owner in self._watched if each.samples)]


class Participant:
    """A participant in a domain, with its endpoints."""

    def __init__(self, domain_id: int) -> None:
        self.wire, self.own, self.guid = wires[domain_id], list[Endpoint](), uuid.uuid4().bytes
        self.wire.participants.append(self)

    def create_writer(self, *topic: Any) -> Endpoint:
        return Endpoint(self, PUBLISHERS, *topic)

    def create_reader(self, *topic: Any, ignore_own: bool = False) -> Endpoint:
        return Endpoint(self, SUBSCRIPTIONS, *topic, ignored=self.guid if ignore_own else b"")

    def create_waiter(self) -> Waiter:
        return Waiter()

    def participants(self, **_: bool) -> set[bytes]:
        return {self.guid, *(each.owner for each in self.wire.endpoints())}

    def endpoints(self, kind: TopicEndpointTypeEnum, topic_name: str | None = None, **_: bool) -> list[Info]:
        return [each for each in self.wire.endpoints() if each.kind == kind and topic_name in (None, each.topic_name)]

    def leave(self) -> None:
        """Leave the domain, with all endpoints."""
        if self in self.wire.participants:
            self.wire.participants.remove(self)
            self.wire.tell()


join = Participant


def encode_nodes(guid: bytes, nodes: Sequence[NodeInfo]) -> bytes:
    """Serialize a participant's announcement of its nodes."""
    return bytes(4) + guid + pickle.dumps(nodes)


def decode_nodes(data: bytes) -> Any:
    """Deserialize an announcement."""
    return pickle.loads(data[20:])


def _misfit(one: EndpointInfo, other: EndpointInfo) -> str:
    """Return what makes two endpoints of a topic incompatible, or `FITS`."""
    writer, reader = (one, other) if one.kind == PUBLISHERS else (other, one)
    if other.type_name != one.type_name:
        return "TYPE"
    offers = zip(_strength(writer.qos), _strength(reader.qos))
    return next((policy for (policy, offered), (_, asked) in offers if offered < asked), FITS)


def _is_kept(qos: QoSProfile) -> bool:
    """Return whether messages are kept for late subscribers."""
    return qos.durability == DurabilityPolicy.TRANSIENT_LOCAL


def _strength(qos: QoSProfile) -> list[tuple[str, float]]:
    """Return the strength that each policy offers or requests; an offer must be at least as strong as the request."""
    return [
        ("DURABILITY", _is_kept(qos)),
        ("DEADLINE", -qos.deadline.nanoseconds),
        ("LIVELINESS", qos.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC),
        ("LIVELINESS", -qos.liveliness_lease_duration.nanoseconds),
        ("RELIABILITY", qos.reliability == ReliabilityPolicy.RELIABLE),
    ]
