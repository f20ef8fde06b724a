"""The facts that the doctor's rules use to infer why no messages arrive."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True)
class Endpoint:
    """A publisher or subscription, with the QoS policies that must be compatible with those of the other endpoint.

    Attributes:
        node: the full name of its node; empty if that is unknown.
        type: its message type, such as ``"sensor_msgs/msg/Joy"``.
        hash: the hash of the type's definition; empty if unknown.
        reliable: whether it is RELIABLE instead of BEST_EFFORT.
        transient_local: whether it is TRANSIENT_LOCAL instead of VOLATILE.
        deadline: the maximum time between two messages [s].
        manual: whether its liveliness is MANUAL_BY_TOPIC instead of AUTOMATIC.
        lease: the lease duration of its liveliness [s].
        lifespan: how long a publisher's message stays valid [s].
    """

    node: str = ""
    type: str = ""
    hash: str = ""
    reliable: bool = True
    transient_local: bool = False
    deadline: float = inf
    manual: bool = False
    lease: float = inf
    lifespan: float = inf


@dataclass(frozen=True)
class Topic:
    """A topic other than the one being examined.

    Attributes:
        name: its full name.
        types: its message types.
        publishers: the number of its publishers; 0 if it has only subscriptions.
    """

    name: str
    types: tuple[str, ...] = ()
    publishers: int = 0


@dataclass(frozen=True)
class Program:
    """A program on this machine that belongs to the same user and has network connections.

    Attributes:
        pid: its process ID.
        command: the beginning of its command, without the folder of its executable.
        domain: its ROS domain.
        joined: whether it uses ports of that domain; if not, it might not be a ROS 2 program.
        stopped: whether it is suspended, as after Ctrl-Z.
        reach: its ``ROS_AUTOMATIC_DISCOVERY_RANGE``; empty if not set.
        rmw: its ``RMW_IMPLEMENTATION``; empty if not set.
    """

    pid: int
    command: str
    domain: int = 0
    joined: bool = False
    stopped: bool = False
    reach: str = ""
    rmw: str = ""


@dataclass(frozen=True)
class Facts:
    """All observations about a topic and about this program.

    Attributes:
        topic: the topic's full name.
        domain: this program's ROS domain.
        reach: this program's ``ROS_AUTOMATIC_DISCOVERY_RANGE``, or its default.
        rmw: this program's middleware.
        import_error: why ROS 2 cannot be imported; empty if it can.
        loopback: whether the loopback interface is up.
        joined: whether this program could join the domain.
        participants: how many of the domain's participant slots (with Cyclone DDS) are in use on this machine;
            counted only if nobody publishes the topic or this program could not join.
        publishers: the topic's publishers.
        subscriptions: the topic's subscriptions, except for the doctor's.
        here: the doctor's subscription, or None if it could not subscribe; ``node`` is ``"the doctor"``.
        installed: whether at least one publisher's type is installed here; True if there are no publishers.
        topics: the other topics in the domain.
        looked_into: the other domains that the doctor has joined, or skipped because no program uses them.
        found_in: the other domains where the topic has publishers.
        programs: the programs on this machine that the doctor can see.
        clock_users: the names of the nodes that subscribe to ``/clock``.
        clock_publishers: the number of publishers of ``/clock``.
        clock_ticks: the number of messages that arrived on ``/clock``.
        seconds: how long the doctor was subscribed [s]; 0 if it could not subscribe.
        received: the number of messages that were published and arrived in that time.
        rate: their rate [Hz]; 0 if fewer than two arrived.
        kept: the number of messages that arrived but had been published before the doctor subscribed.
        unmoved: the number of received joint states that move no joint.
        complaint: the joint matcher's most frequent report on these joint states.
    """

    topic: str
    domain: int = 0
    reach: str = "LOCALHOST"
    rmw: str = "rmw_cyclonedds_cpp"
    import_error: str = ""
    loopback: bool = True
    joined: bool = True
    participants: int = 0
    publishers: tuple[Endpoint, ...] = ()
    subscriptions: tuple[Endpoint, ...] = ()
    here: Endpoint | None = None
    installed: bool = True
    topics: tuple[Topic, ...] = ()
    looked_into: tuple[int, ...] = ()
    found_in: tuple[int, ...] = ()
    programs: tuple[Program, ...] = ()
    clock_users: tuple[str, ...] = ()
    clock_publishers: int = 0
    clock_ticks: int = 0
    seconds: float = 0.0
    received: int = 0
    rate: float = 0.0
    kept: int = 0
    unmoved: int = 0
    complaint: str = ""

    @property
    def blind(self) -> bool:
        """Whether no topics are visible to this program."""
        return bool(self.import_error) or not (self.loopback and self.joined)

    @property
    def silent(self) -> bool:
        """Whether there are publishers but none of them has sent a message."""
        return bool(self.publishers) and self.seconds > 0 and not self.received and not self.kept
