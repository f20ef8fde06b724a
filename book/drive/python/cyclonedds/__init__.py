"""Replace Cyclone DDS in the browser: carry messages between the programs of one page.

This package contains only the parts of Cyclone DDS that the pocket ROS 2 uses; ``qos`` and ``idl`` are Cyclone DDS's
own Python modules. A published message reaches the readers in the same program at once, as CDR bytes, and `Wire`
passes it on to the page's other programs. No message leaves the page.
"""

import copyreg
import pickle
import sys
import threading
import time
import uuid
from collections import defaultdict, deque
from itertools import chain
from types import SimpleNamespace
from typing import Any

from cyclonedds.qos import Policy, Qos

for module in ("core", "domain", "pub", "sub", "topic"):
    sys.modules[f"{__name__}.{module}"] = sys.modules[__name__]  # this module replaces all of these

FITS, DURABILITY, DEADLINE, LIVELINESS, RELIABILITY, ANOTHER_TYPE = 0, 2, 4, 8, 11, 24
"""DDS's numbers for the reason why two endpoints don't match; `FITS` means that they do."""

copyreg.pickle(Qos, lambda policies: (Qos.fromdict, (policies.asdict(),)))

changed = threading.Condition(threading.RLock())
"""Held while endpoints or messages are added or removed, and notified afterwards."""


class DDSException(Exception):  # noqa: N818  (Cyclone DDS's name)
    """Cyclone DDS's error. Nothing in this package raises it."""


class Entity:
    """Base class of everything that belongs to a participant or a reader.

    Other programs receive it as a namespace with the attributes listed in `TOLD`.

    Attributes:
        is_ready: whether to wake an executor that waits for it.
    """

    TOLD: tuple[str, ...] = ()
    is_ready: Any = False
    _ref = property(lambda self: self)

    def __init__(self, owner: Any, *_: object) -> None:
        self.owner = owner

    def __reduce__(self) -> Any:
        """Pickle it as a namespace for the other programs."""
        return SimpleNamespace, (), {name: getattr(self, name) for name in self.TOLD}

    def __del__(self) -> None:
        """Delete it. The pocket ROS 2 calls this explicitly."""


class Wire:
    """The publishers and subscriptions in a domain: in this program, and in the page's other programs.

    Attributes:
        participants: this program's participants.
        others: the participants that each of the other programs has announced.
        send: called with the topic, its type, the writer's identifier and the bytes for the other programs.
        announce: called with bytes for the other programs' `hear`.
    """

    def __init__(self) -> None:
        self.participants: list[Participant] = []
        self.others: dict[str, list[Any]] = {}
        self.send = self.announce = lambda *_: None

    def own_endpoints(self) -> list[Any]:
        """Return the endpoints of this program."""
        return [each for participant in self.participants for each in participant.endpoints]

    def everywhere(self, what: str) -> list[Any]:
        """Return all ``endpoints`` or ``nodes`` of the page, those of this program first."""
        participants = chain(self.participants, *self.others.values())
        return [each for participant in participants for each in getattr(participant, what)]

    def hear(self, program: str, described: Any) -> None:
        """Store an announcement from another program's `tell`."""
        self.others[program] = pickle.loads(described)
        self._compare()

    def tell(self) -> None:
        """Announce this program's endpoints and nodes after a change."""
        self._compare()
        self.announce(pickle.dumps(self.participants))

    def deliver(self, guid: str, data: Any) -> None:
        """Deliver a writer's message to this program's matching readers; the writer may be in a different program."""
        with changed:
            for each in self.own_endpoints():
                if each.partners.get(guid) == FITS:
                    each.put(data)
            changed.notify_all()

    def _compare(self) -> None:
        with changed:
            everyone = self.everywhere("endpoints")
            for each in self.own_endpoints():
                each.compare(everyone)
            changed.notify_all()


wires: dict[int, Wire] = defaultdict(Wire)
"""The wire of each domain, by its number."""


class Participant(Entity):
    """A participant in a domain, with its endpoints, and its nodes as `Graph` describes them."""

    TOLD = ("endpoints", "nodes")

    def __init__(self, domain_id: int, *_: object) -> None:
        self.wire, self.endpoints, self.nodes = wires[domain_id], list[Endpoint](), list[SimpleNamespace]()
        self.wire.participants.append(self)

    def __del__(self) -> None:
        """Leave the domain, with all endpoints and nodes."""
        if self in self.wire.participants:
            self.wire.participants.remove(self)
            self.wire.tell()


Domain = DomainParticipant = Participant


class Topic(Entity):
    """A topic: its name and the type of its payloads."""

    def __init__(self, _participant: Participant, name: str, data_type: Any) -> None:
        self.name, self.data_type = name, data_type


class Endpoint(Entity):
    """Base class of writers and readers.

    Attributes:
        partners: maps each endpoint at the other end of its topic, by identifier, to the reason why the two don't
            match, or to `FITS`.
    """

    TOLD = ("guid", "is_writer", "topic_name", "type_name", "qos")
    is_writer = False

    def __init__(self, participant: Participant, topic: Topic, policies: Qos) -> None:
        super().__init__(participant)
        self.guid, self.qos, self._payload = uuid.uuid4(), policies, topic.data_type
        self.topic_name, self.type_name = topic.name, topic.data_type.__idl_typename__
        self.partners, self._last_misfit = dict[str, int](), FITS
        with changed:
            participant.endpoints.append(self)
        participant.wire.tell()

    def __del__(self) -> None:
        """Leave the domain."""
        if self in self.owner.endpoints:
            self.owner.endpoints.remove(self)
            self.owner.wire.tell()

    def misfit(self, other: Any) -> int:
        """Return DDS's number for the reason why it does not match a partner, or `FITS`."""
        writer, reader = (self, other) if self.is_writer else (other, self)
        if other.type_name != self.type_name:
            return ANOTHER_TYPE
        offers = zip(_strength(writer.qos), _strength(reader.qos))
        return next((policy for (policy, offered), (_, asked) in offers if offered < asked), FITS)

    def compare(self, everyone: list[Any]) -> None:
        """Find its partners among all endpoints, and remember new ones that do not match."""
        known, self.partners = self.partners, {}
        for each in everyone:
            if each.topic_name == self.topic_name and each.is_writer != self.is_writer:
                misfit = self.partners[each.guid.hex] = self.misfit(each)
                if misfit and each.guid.hex not in known:
                    self._last_misfit, self.is_ready = misfit, True

    def set_status_mask(self, _mask: int) -> None:
        """Do nothing: it always watches for partners that do not match."""

    def take_status(self, _mask: int) -> bool:
        """Return whether a partner that does not match has appeared since the last call."""
        unsaid, self.is_ready = self.is_ready, False
        return unsaid

    def status(self) -> Any:
        """Return the number of matching partners, and the policy of the last one that does not match."""
        return SimpleNamespace(current_count=[*self.partners.values()].count(FITS), last_policy_id=self._last_misfit)

    get_offered_incompatible_qos_status = get_requested_incompatible_qos_status = status
    get_publication_matched_status = get_subscription_matched_status = status


class DataWriter(Endpoint):
    """Sends payloads."""

    is_writer = True

    def __init__(self, participant: Participant, topic: Topic, policies: Qos) -> None:
        self.kept: deque[bytes] = deque(maxlen=_depth(policies) if _is_kept(policies) else 0)
        super().__init__(participant, topic, policies)

    def write(self, payload: Any) -> None:
        """Send a payload to the matching readers."""
        self.kept.append(payload.data)
        self.owner.wire.deliver(self.guid.hex, payload.data)
        self.owner.wire.send(self.topic_name, self.type_name, self.guid.hex, payload.data)

    def wait_for_acks(self, _timeout: int) -> bool:
        """Return True: readers receive every payload at once."""
        return True


class DataReader(Endpoint):
    """Keeps payloads until they are taken."""

    def __init__(self, participant: Participant, topic: Topic, policies: Qos) -> None:
        self.samples: deque[Any] = deque(maxlen=_depth(policies))
        super().__init__(participant, topic, policies)
        for each in participant.wire.own_endpoints() if _is_kept(policies) else ():
            for data in each.kept if self.partners.get(each.guid.hex) == FITS else ():
                self.put(data)

    def put(self, data: bytes) -> None:
        """Store a published message."""
        payload = self._payload.deserialize(bytes(data))
        payload.sample_info = SimpleNamespace(valid_data=True, source_timestamp=time.time_ns())
        self.samples.append(payload)

    def take(self, count: int) -> list[Any]:
        """Remove and return up to `count` payloads."""
        with changed:
            return [self.samples.popleft() for _ in range(min(count, len(self.samples)))]


class ReadCondition(Entity):
    """Is ready while a reader has payloads."""

    is_ready = property(lambda self: bool(self.owner.samples))


class GuardCondition(Entity):
    """Is ready once it has been set explicitly."""

    def set(self, value: bool) -> None:
        """Set it."""
        with changed:
            self.is_ready = value
            changed.notify_all()

    def take(self) -> None:
        """Reset it."""
        self.is_ready = False


class WaitSet(Entity):
    """Waits for several entities."""

    def __init__(self, _participant: Participant) -> None:
        self._attached: dict[int, Entity] = {}

    def _waitset_attach(self, _ref: object, entity: Entity, key: int) -> None:
        self._attached[key] = entity

    def _waitset_wait(self, _ref: object, keys: list[int | None], _size: int, timeout_ns: int) -> int:
        """Wait up to a timeout [ns], write the keys of the ready entities, and return their number."""
        with changed:
            ready = changed.wait_for(self._ready, max(0, timeout_ns) / 1e9)
        keys[: len(ready)] = ready
        return len(ready)

    def _ready(self) -> list[int]:
        return [key for key, entity in self._attached.items() if entity.is_ready]


DDSStatus = SimpleNamespace(OfferedIncompatibleQos=1, RequestedIncompatibleQos=1)
InstanceState = SampleState = ViewState = SimpleNamespace(Any=0)


def _depth(policies: Qos) -> int | None:
    """Return how many messages to keep; None for all."""
    return getattr(policies[Policy.History], "depth", None)


def _is_kept(policies: Qos) -> bool:
    """Return whether messages are kept for late subscribers."""
    return bool(policies[Policy.Durability] == Policy.Durability.TransientLocal)


def _strength(policies: Qos) -> list[tuple[int, float]]:
    """Return the strength that each policy offers or asks for; an offer must be at least as strong as the request."""
    liveliness = policies[Policy.Liveliness]
    return [
        (DURABILITY, _is_kept(policies)),
        (DEADLINE, -policies[Policy.Deadline].deadline),
        (LIVELINESS, isinstance(liveliness, Policy.Liveliness.ManualByTopic)),
        (LIVELINESS, -liveliness.lease_duration),
        (RELIABILITY, policies[Policy.Reliability] != Policy.Reliability.BestEffort),
    ]
