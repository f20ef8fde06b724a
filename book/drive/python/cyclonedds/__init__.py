"""Stands where Cyclone DDS is for the pocket ROS 2: it carries messages between the programs of one page.

It has what the pocket ROS 2 asks of the package of this name, and no more; ``qos`` and ``idl``, which are Python, are
Cyclone DDS's own. What is published reaches the readers of the same program at once, as CDR bytes. `Wire` hands it on
to the page's other programs. Nothing leaves the page.
"""

from __future__ import annotations

import json
import sys
import threading
import time
import uuid
from collections import defaultdict, deque
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

from cyclonedds.qos import Policy, Qos

for module in ("core", "domain", "pub", "sub", "topic"):
    sys.modules[f"{__name__}.{module}"] = sys.modules[__name__]  # all of these are this one

DURABILITY, DEADLINE, LIVELINESS, RELIABILITY, ANOTHER_TYPE = 2, 4, 8, 11, 24
"""DDS's numbers of what keeps two endpoints apart."""

changed = threading.Condition(threading.RLock())
"""Held where endpoints or messages come and go, and told."""


class DDSException(Exception):  # noqa: N818  (Cyclone DDS's name)
    """What Cyclone DDS raises, and nothing here does."""


class Entity:
    """Base of what belongs to a participant."""

    _entities: dict[int, Entity] = {}
    wire: Wire

    def __init__(self, participant: Participant) -> None:
        self.wire = participant.wire
        self._ref = self

    def is_ready(self) -> bool:
        """Whether an executor that waits for it is to wake."""
        return False

    def __del__(self) -> None:
        """Delete it, which the pocket ROS 2 calls by hand."""


@dataclass(eq=False)
class Node:
    """A node, with the identifiers of its endpoints, and of this program's nodes the participant."""

    node_namespace: str
    node_name: str
    guids: list[bytes]
    participant: Participant | None = None


class Wire:
    """Who publishes and subscribes in a domain: in this program, and in the page's other programs.

    Attributes:
        endpoints: of this program.
        nodes: of this program.
        others: by program, its endpoints and nodes.
        send: called with topic, type and bytes of what the other programs are to receive.
        announce: called with `described` whenever that changes.
    """

    def __init__(self) -> None:
        self.endpoints: list[Endpoint] = []
        self.nodes: list[Node] = []
        self.others: dict[str, tuple[list[Any], list[Node]]] = {}
        self.send: Callable[[str, str, bytes], object] = lambda *_: None
        self.announce: Callable[[str], object] = lambda _: None

    def everyone(self) -> list[Any]:
        """Return all endpoints of the page."""
        return [*self.endpoints, *(each for endpoints, _ in self.others.values() for each in endpoints)]

    def all_nodes(self) -> list[Node]:
        """Return all nodes of the page."""
        return [*self.nodes, *(each for _, nodes in self.others.values() for each in nodes)]

    def described(self) -> str:
        """Write down this program's endpoints and nodes, for `hear`."""
        names = ("is_writer", "topic_name", "type_name")
        endpoints = [
            {name: getattr(each, name) for name in names} | {"guid": each.guid.hex, "qos": each.qos.asdict()}
            for each in self.endpoints
        ]
        nodes = [(each.node_namespace, each.node_name, [guid.hex() for guid in each.guids]) for each in self.nodes]
        return json.dumps((endpoints, nodes))

    def hear(self, program: str, described: str) -> None:
        """Take note of another program's endpoints and nodes."""
        endpoints, nodes = json.loads(described)
        for each in endpoints:
            each |= {"guid": uuid.UUID(each["guid"]), "qos": Qos.fromdict(each["qos"])}
        self.others[program] = (
            [SimpleNamespace(**each) for each in endpoints],
            [Node(namespace, name, [*map(bytes.fromhex, guids)]) for namespace, name, guids in nodes],
        )
        self._compare()

    def tell(self) -> None:
        """Say that this program's endpoints or nodes have changed."""
        self._compare()
        self.announce(self.described())

    def receive(self, topic: str, type_name: str, data: Any) -> None:
        """Give readers that a writer fits what another program has published: bytes, as JavaScript has them."""
        with changed:
            for each in self.endpoints:
                is_asked = isinstance(each, DataReader) and (each.topic_name, each.type_name) == (topic, type_name)
                if is_asked and each.matched().current_count:
                    each.put(data.to_bytes())
            changed.notify_all()

    def _compare(self) -> None:
        with changed:
            for each in self.endpoints:
                each.compare(self.everyone())
            changed.notify_all()


wires: dict[int, Wire] = defaultdict(Wire)
"""By the number of the domain."""


class Participant(Entity):
    """A domain, and a participant in one."""

    def __init__(self, domain_id: int, *_: object) -> None:
        self.wire = wires[domain_id]
        super().__init__(self)

    def __del__(self) -> None:
        """Leave the domain, with all endpoints and nodes."""
        left = [each for each in self.wire.endpoints if each.participant is self]
        self.wire.nodes = [each for each in self.wire.nodes if each.participant is not self]
        for each in left:
            each.__del__()


Domain = DomainParticipant = Participant


class Topic:
    """A topic's name, and the type of its payloads."""

    def __init__(self, _participant: Participant, name: str, data_type: Any) -> None:
        self.name, self.data_type = name, data_type

    def __del__(self) -> None:
        """Delete it."""


class Endpoint(Entity):
    """What a writer and a reader have in common."""

    is_writer = False

    def __init__(self, participant: Participant, topic: Topic, policies: Qos) -> None:
        super().__init__(participant)
        self.participant = participant
        self.guid = uuid.uuid4()
        self.topic_name, self.type_name = topic.name, topic.data_type.__idl_typename__
        self.qos = policies
        self._payload = topic.data_type
        self._misfits: dict[uuid.UUID, int] = {}
        self._unsaid = False
        with changed:
            self.wire.endpoints.append(self)
        self.wire.tell()

    def __del__(self) -> None:
        """Leave the domain."""
        if self in self.wire.endpoints:
            self.wire.endpoints.remove(self)
            self.wire.tell()

    def misfit(self, other: Any) -> int:
        """Return what keeps it and a partner on the same topic apart, as DDS numbers it; 0 if nothing does."""
        writer, reader = (self, other) if self.is_writer else (other, self)
        if other.type_name != self.type_name:
            return ANOTHER_TYPE
        offers = zip(_strength(writer.qos), _strength(reader.qos))
        return next((policy for (policy, offered), (_, asked) in offers if offered < asked), 0)

    def partners(self, everyone: list[Any]) -> list[Any]:
        """Return those at the other end of its topic, whether they fit or not."""
        return [each for each in everyone if each.topic_name == self.topic_name and each.is_writer != self.is_writer]

    def compare(self, everyone: list[Any]) -> None:
        """Note partners that do not fit."""
        found = {each.guid: misfit for each in self.partners(everyone) if (misfit := self.misfit(each))}
        self._unsaid = self._unsaid or not found.keys() <= self._misfits.keys()
        self._misfits |= found

    def is_ready(self) -> bool:
        """Whether a partner has come that does not fit."""
        return self._unsaid

    def set_status_mask(self, _mask: int) -> None:
        """Watch for partners that do not fit, which it does anyway."""

    def take_status(self, _mask: int) -> bool:
        """Say whether one has come since the last time."""
        unsaid, self._unsaid = self._unsaid, False
        return unsaid

    def incompatible(self) -> Any:
        """Tell of the last one."""
        return SimpleNamespace(last_policy_id=list(self._misfits.values())[-1])

    def matched(self) -> Any:
        """Count the partners that fit."""
        fitting = [each for each in self.partners(self.wire.everyone()) if not self.misfit(each)]
        return SimpleNamespace(current_count=len(fitting))

    get_offered_incompatible_qos_status = get_requested_incompatible_qos_status = incompatible
    get_publication_matched_status = get_subscription_matched_status = matched


class DataWriter(Endpoint):
    """Sends payloads."""

    is_writer = True

    def __init__(self, participant: Participant, topic: Topic, policies: Qos) -> None:
        self.kept: deque[bytes] = deque(maxlen=_depth(policies) if _is_kept(policies) else 0)
        super().__init__(participant, topic, policies)

    def write(self, payload: Any) -> None:
        """Give it to the readers that fit."""
        with changed:
            self.kept.append(payload.data)
            for each in self.partners(self.wire.endpoints):
                if not self.misfit(each):
                    each.put(payload.data)
            changed.notify_all()
        self.wire.send(self.topic_name, self.type_name, payload.data)

    def wait_for_acks(self, _timeout: int) -> bool:
        """Say that all was received: it is received at once."""
        return True


class DataReader(Endpoint):
    """Keeps payloads until they are taken."""

    def __init__(self, participant: Participant, topic: Topic, policies: Qos) -> None:
        self.samples: deque[Any] = deque(maxlen=_depth(policies))
        super().__init__(participant, topic, policies)
        for writer in self.partners(self.wire.endpoints) if _is_kept(policies) else ():
            for data in () if self.misfit(writer) else writer.kept:
                self.put(data)

    def put(self, data: bytes) -> None:
        """Keep what was published."""
        payload = self._payload.deserialize(data)
        payload.sample_info = SimpleNamespace(valid_data=True, source_timestamp=time.time_ns())
        self.samples.append(payload)

    def take(self, count: int) -> list[Any]:
        """Return so many payloads, if there are."""
        with changed:
            return [self.samples.popleft() for _ in range(min(count, len(self.samples)))]


class ReadCondition(Entity):
    """Is ready while a reader has payloads."""

    def __init__(self, reader: DataReader, _state: int) -> None:
        self._reader = reader
        self._ref = self

    def is_ready(self) -> bool:
        """Whether it has."""
        return bool(self._reader.samples)


class GuardCondition(Entity):
    """Is ready when it was set by hand."""

    _is_set = False

    def set(self, value: bool) -> None:
        """Set it."""
        with changed:
            self._is_set = value
            changed.notify_all()

    def take(self) -> None:
        """Set it back."""
        self._is_set = False

    def is_ready(self) -> bool:
        """Whether it is set."""
        return self._is_set


class WaitSet(Entity):
    """Waits for several entities."""

    def __init__(self, participant: Participant) -> None:
        super().__init__(participant)
        self._attached: dict[int, Entity] = {}

    def _waitset_attach(self, _ref: object, entity: Entity, key: int) -> None:
        self._attached[key] = entity

    def _waitset_wait(self, _ref: object, keys: list[int | None], _size: int, timeout_ns: int) -> int:
        """Wait [ns], write the keys of those that are ready, and return how many they are."""
        with changed:
            if timeout_ns > 0:
                changed.wait_for(self._ready, timeout_ns / 1e9)
            ready = self._ready()
        keys[: len(ready)] = ready
        return len(ready)

    def _ready(self) -> list[int]:
        return [key for key, entity in self._attached.items() if entity.is_ready()]


DDSStatus = SimpleNamespace(OfferedIncompatibleQos=1, RequestedIncompatibleQos=1)
InstanceState = SampleState = ViewState = SimpleNamespace(Any=0)


def _depth(policies: Qos) -> int | None:
    """Return how many messages are kept; None for all."""
    return getattr(policies[Policy.History], "depth", None)


def _is_kept(policies: Qos) -> bool:
    """Whether messages are kept for those who come late."""
    return bool(policies[Policy.Durability] == Policy.Durability.TransientLocal)


def _strength(policies: Qos) -> list[tuple[int, float]]:
    """Return how much each policy offers, or asks for, which has to be no more."""
    liveliness = policies[Policy.Liveliness]
    return [
        (DURABILITY, _is_kept(policies)),
        (DEADLINE, -policies[Policy.Deadline].deadline),
        (LIVELINESS, isinstance(liveliness, Policy.Liveliness.ManualByTopic)),
        (LIVELINESS, -liveliness.lease_duration),
        (RELIABILITY, policies[Policy.Reliability] != Policy.Reliability.BestEffort),
    ]
