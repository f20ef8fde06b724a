"""Matching joints by name: the second of the two ideas that the tutorial is about.

In a ``sensor_msgs/JointState`` the names identify the joints. A viewer that uses the i-th entry for its i-th joint
shows the wrong pose as soon as a publisher sends its joints in a different order, or only some of them.
`match_joints` implements the idea. `JointMatcher` also detects late messages, and rivals: other publishers of the same
joints.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from math import inf, isfinite
from typing import TYPE_CHECKING, NamedTuple

from tutorial.errors import did_you_mean

if TYPE_CHECKING:
    from sensor_msgs.msg import JointState

NAMES_KEPT = 3  # in each `NameList`, so that a report is small even if a message has many names
SECOND_NS = 1_000_000_000  # [ns] a stamp that jumps back by more than this means that the publisher was restarted
PAUSE_NS = 10 * SECOND_NS  # [ns] the longest allowed pause between messages from one of several publishers
SHOWABLE = 1e9  # [rad or m] largest usable position; views use single precision, which can represent even its square
SLACK = 1e-3  # [rad or m] a range can be exceeded by this much without a report, because simulated limits are soft
REACH, SPEED = 0.1, 5.0  # [rad, rad/s] or [m, m/s]: moving further than REACH + SPEED * time is a jump
# A jump counts as a jump back to the position before last, or as a jump to a rival's position, if it misses that
# position by less than this fraction of its length.
NEAR, NEAR_RIVAL = 1 / 5, 1 / 3
COUNT_EVERY = 10  # messages between counts of the publishers while there is only one
SILENT_AFTER = 25  # dropped messages in a row, per rival, before the followed publisher counts as silent
# After this many jumps back, a joint counts as shared. Any other jump cancels this fraction of a jump back.
SHARED_AFTER, CANCELLED = 60, 1 / 4
Ranges = Mapping[str, tuple[float, float]]


def match_joints(joints: Ranges | Iterable[str], message: JointState) -> tuple[dict[str, float], JointReport]:
    """Match one message with the joints of a body.

    Args:
        joints: the names of a body's joints, or a mapping from each name to a range ``(lower, upper)`` [rad or m].
        message: the message; its type must be right, but its fields can contain anything.

    Returns:
        The position [rad or m] of each joint with a usable number (the last number if a joint has several), and the
        report.
    """
    ranges, names, positions = _ranges(joints), message.name, message.position
    unknown = [name for name in names if name not in ranges]
    pairs = [(name, position) for name, position in zip(names, positions) if name in ranges]
    usable = {joint: position for joint, position in pairs if abs(position) <= SHOWABLE}  # excludes NaN; the last wins
    received = dict(pairs) | usable  # in message order; a joint has an unusable number only if it has no usable one
    shown = {joint: position for joint, position in received.items() if joint in usable}
    limits = {joint: _with_slack(ranges[joint]) for joint in shown}
    return shown, JointReport(
        joints=tuple(shown),
        unknown=NameList.of(unknown),
        duplicate=NameList.of([joint for joint, count in Counter(joint for joint, _ in pairs).items() if count > 1]),
        short=max(len(names) - len(positions), 0) if len(positions) else 0,  # ROS allows a message without positions
        long=max(len(positions) - len(names), 0),
        non_finite=NameList.of([joint for joint, position in received.items() if not isfinite(position)]),
        huge=NameList.of([joint for joint, position in received.items() if SHOWABLE < abs(position) < inf]),
        outside=NameList.of([joint for joint, (low, high) in limits.items() if not low <= shown[joint] <= high]),
        known=tuple(ranges) if unknown else (),
    )


class NameList(NamedTuple):
    """A group of names: how many there are, and the first few of them."""

    total: int = 0
    names: tuple[str, ...] = ()

    @classmethod
    def of(cls, names: Sequence[str]) -> NameList:
        """Count the names and store the first few, each truncated to 40 characters."""
        return cls(len(names), tuple(name[:40] for name in names[:NAMES_KEPT])) if names else cls()

    def __str__(self) -> str:
        more = f" and {self.total - len(self.names)} more" if self.total > len(self.names) else ""
        return ", ".join(map(repr, self.names)) + more


class Arrival(Enum):
    """How a message follows the previous ones.

    If the joints of a message have different values, the report contains the value that is listed last here.
    """

    NEXT = ""  #: the publisher's next message
    RESTARTED = "the publisher was restarted"  #: the message's stamp jumps far back
    SWITCHED = "the publisher was restarted or is silent, and the viewer follows a new one"  #: its publisher
    LATE = "a late message was dropped"  #: older than the message that last moved the joint
    ANOTHER = "a message from another publisher was dropped"  #: not from the publisher that is followed


class JointReport(NamedTuple):
    """The result of matching one message."""

    joints: tuple[str, ...] = ()  #: the joints that received a position
    arrival: Arrival = Arrival.NEXT  #: how the message relates to the previous ones
    unmoved: NameList = NameList()  #: joints that did not move, because their positions were late or came from a rival
    unknown: NameList = NameList()  #: names that the body has no joint for
    duplicate: NameList = NameList()  #: joints named more than once; the last usable number was used
    short: int = 0  #: the number of names without a position
    long: int = 0  #: the number of positions without a name
    non_finite: NameList = NameList()  #: joints whose position was NaN or infinite; they did not move
    huge: NameList = NameList()  #: joints whose position was beyond 1e9, too large to draw; they did not move
    outside: NameList = NameList()  #: joints whose position is outside their range; the view shows them as received
    known: tuple[str, ...] = ()  #: all joints of the body, for suggestions; empty if every name was known

    @property
    def dropped(self) -> bool:
        """Whether the message moved no joint, because it was late or came from a rival."""
        return self.arrival in (Arrival.LATE, Arrival.ANOTHER) and not self.joints

    @property
    def clean(self) -> bool:
        """Whether the message was the next one and had no faults."""
        return self == JointReport(self.joints, known=self.known)

    def counts(self) -> dict[str, int]:
        """Return the number of joints or names of each kind, to be summed over many messages."""
        arrivals = {each.name.lower(): int(each is self.arrival) for each in Arrival if each is not Arrival.NEXT}
        found = {kind: getattr(self, kind) for kind in self._fields[2:-1]}  # from `unmoved` to `outside`
        totals = {kind: each.total if isinstance(each, NameList) else each for kind, each in found.items()}
        return {"matched": len(self.joints), **arrivals, **totals}

    def __str__(self) -> str:
        """Return the line for the log and for the text below the 3D view."""
        if self.dropped:
            return self.arrival.value
        shown = f"{len(self.joints)} joint{'s' * (len(self.joints) != 1)} shown"
        arrival = self.arrival.value + (f" for {self.unmoved}" if self.unmoved.total else "")
        hint = did_you_mean(self.unknown.names[0], self.known) if self.unknown.total else ""
        complaints = (
            (self.arrival.value, arrival),
            (self.unknown.total, f"unknown {self.unknown}.{hint}"),
            (self.duplicate.total, f"named twice (the last number is used): {self.duplicate}"),
            (self.short, f"no position for the last {'name' if self.short == 1 else f'{self.short} names'}"),
            (self.long, f"positions without a name: {self.long}"),
            (self.non_finite.total, f"not a finite number: {self.non_finite}"),
            (self.huge.total, f"too large to show: {self.huge}"),
            (self.outside.total, f"outside its range: {self.outside}"),
        )
        return "; ".join([shown, *(text for found, text in complaints if found)])

    def __repr__(self) -> str:
        return f"JointReport({str(self)!r})"


class JointMatcher:
    """Decides which joints each message of one topic moves. It has no thread and no clock.

    `match_joints` matches the names. Then each joint is judged separately, against the message that moved it last: an
    older message is late, and a message more than a second older means that the publisher was restarted. If
    publishers have no joints in common, all of their joints are shown. If a joint has several publishers, one of them
    is followed until it stops publishing.

    Args:
        joints: the names of the body's joints, or a mapping from each name to a range ``(lower, upper)`` [rad or m].
        publishers: returns the number of publishers on the topic, such as a subscription's ``get_publisher_count``.
    """

    def __init__(self, joints: Ranges | Iterable[str], publishers: Callable[[], int] = lambda: 1) -> None:
        self._ranges = dict(_ranges(joints))
        self._publishers = _Publishers(self._ranges, publishers)
        self._tracks: dict[str, _Track] = {}  # by joint, for joints that a message has moved
        self._last, self._plan = _Track({}, -inf), _Plan()  # the joints that the last message moved, and its plan

    def match(self, message: JointState) -> tuple[dict[str, float], JointReport]:
        """Match the next message as `match_joints` does, but move no joint whose position is late or from a rival."""
        stamp, last, plan = message.header.stamp, self._last, self._plan
        stamp_ns = stamp.sec * SECOND_NS + stamp.nanosec
        ahead = stamp_ns - last.stamp_ns  # infinite for the first message
        steady = 0 < ahead <= SECOND_NS or ahead == stamp_ns == 0  # both are 0 if the publisher does not set the stamps
        if steady and plan.names == message.name and plan.length == len(message.position) and self._publishers.alone():
            positions = plan.positions(list(message.position))  # reading a list is faster than reading an array
            if positions is not None:
                last.positions, last.stamp_ns, last.dropped = positions, stamp_ns, 0
                return positions, plan.report
        return self._judge(message, stamp_ns)

    def _judge(self, message: JointState, stamp_ns: int) -> tuple[dict[str, float], JointReport]:
        """Match a message that no shortcut applies to, and decide which of its joints it moves."""
        positions, report = match_joints(self._ranges, message)
        if not positions:
            return {}, report
        rivals = self._publishers.rivals(positions)
        arrivals = dict.fromkeys(positions, Arrival.NEXT)  # by joint
        for track in {self._tracks[joint] for joint in positions if joint in self._tracks}:
            part = {joint: position for joint, position in positions.items() if self._tracks.get(joint) is track}
            arrivals |= dict.fromkeys(part, self._publishers.arrival(track, part, stamp_ns, rivals))
        arrival = max(arrivals.values(), key=list(Arrival).index)
        unmoved = [joint for joint in positions if arrivals[joint] in (Arrival.LATE, Arrival.ANOTHER)]
        shown = {joint: position for joint, position in positions.items() if joint not in unmoved}
        if not shown:
            return {}, JointReport(arrival=arrival)
        self._last = _Track(shown, stamp_ns)
        self._tracks |= dict.fromkeys(shown, self._last)
        usual = not (rivals or unmoved or report.non_finite.total or report.huge.total)  # every named joint has moved
        self._plan = _Plan.of(self._ranges, message, report) if usual else _Plan()
        return shown, report._replace(joints=tuple(shown), arrival=arrival, unmoved=NameList.of(unmoved))


@dataclass(slots=True, eq=False)
class _Track:
    """Joints that were last moved by the same message. A message that takes the shortcut updates the track in place."""

    positions: Mapping[str, float]  # the positions in that message; some of these joints may have moved since
    stamp_ns: float  # the message's; -inf before the first message
    dropped: int = 0  # the number of rivals' messages dropped in a row since that message


class _Publishers:
    """Tells the publishers of one topic apart by their messages, because in rclpy a message does not name its sender.

    If there are as many separate sets of joints as publishers, no joint is shared, unless a joint keeps jumping back
    and forth. Otherwise a message comes from a rival if it is older than the last one, more than 10 s newer, or makes a
    joint jump. Once a single rival's position of the joint is known, only a jump to that position indicates a rival. If
    the publishers agree, all of their messages move the joints.
    """

    def __init__(self, ranges: Ranges, count: Callable[[], int]) -> None:
        self._half_range = {joint: (upper - low) / 2 for joint, (low, upper) in ranges.items()}  # beyond: a jump
        self._count_publishers, self._last_count = count, 0
        self._until_recount = 0  # messages until the publishers are counted again
        self._groups: list[set[str]] = []  # separate sets of joints that are published together
        self._rival_positions: dict[str, float] = {}  # each joint's last position from a rival
        self._history: dict[str, tuple[float, float, float]] = {}  # last position, position before last, jumps back

    def alone(self) -> bool:
        """Return whether there is only one publisher. Publishers are counted once every few messages."""
        self._until_recount -= 1
        return self._until_recount >= 0 or self._recount() <= 1

    def rivals(self, positions: Mapping[str, float]) -> int:
        """Record which joints are published together, and count the other publishers that may share them."""
        count, joints = self._recount(), set(positions)
        apart = [group for group in self._groups if count > 1 and group.isdisjoint(joints)]
        self._groups = [*apart, joints.union(*(group for group in self._groups if group not in apart))]
        shared = count > 1 and max([self._jumps_back(*each) for each in positions.items()]) >= SHARED_AFTER
        return max(count - 1 - len(apart), shared)  # each separate group has a different publisher

    def arrival(self, track: _Track, positions: Mapping[str, float], stamp_ns: int, rivals: int) -> Arrival:
        """Decide how a message follows the one that moved these joints last, and count it if it is dropped."""
        ahead = stamp_ns - track.stamp_ns
        if not rivals and not track.dropped:  # these joints have one publisher, and it sent the last message
            back = Arrival.RESTARTED if ahead < -SECOND_NS or stamp_ns <= 0 else Arrival.LATE
            return back if ahead < 0 else Arrival.NEXT
        if 0 <= ahead <= PAUSE_NS and not self._jumps_to_rival(track, positions, ahead, rivals):
            return Arrival.NEXT
        track.dropped += 1
        switches = track.dropped >= SILENT_AFTER * rivals  # immediately if no rival is left
        rival = track.positions if switches else positions  # the rival is the publisher not followed from now on
        self._rival_positions |= {joint: rival[joint] for joint in positions}
        return Arrival.SWITCHED if switches else Arrival.ANOTHER

    def _jumps_to_rival(self, track: _Track, positions: Mapping[str, float], ahead: float, rivals: int) -> bool:
        """Return whether a joint jumps further than its publisher could move it, perhaps to a rival's position."""
        reach = REACH + SPEED * ahead / SECOND_NS
        moved = {joint: abs(position - track.positions[joint]) for joint, position in positions.items()}
        far = [joint for joint in moved if moved[joint] > min(reach, self._half_range[joint])]
        off = {joint: abs(positions[joint] - self._rival_positions.get(joint, positions[joint])) for joint in far}
        return any(rivals > 1 or off[joint] < NEAR_RIVAL * moved[joint] for joint in far)

    def _jumps_back(self, joint: str, position: float) -> float:
        """Count a joint's jumps back to its position before last. Any other jump reduces the count."""
        last, before, jumps = self._history.get(joint, (position, inf, 0))
        moved = abs(position - last)
        if moved > min(REACH, self._half_range[joint]):
            jumps = jumps + 1 if abs(position - before) < NEAR * moved else max(jumps - CANCELLED, 0)
        self._history[joint] = position, last, jumps
        return jumps

    def _recount(self) -> int:
        count = self._count_publishers()
        if count < self._last_count:  # a publisher has disappeared, but it is unknown which one
            self._groups, self._rival_positions, self._history = [], {}, {}
        self._last_count, self._until_recount = count, 0 if count > 1 else COUNT_EVERY - 1
        return count


class _Plan(NamedTuple):
    """A shortcut for messages with the same names as the last one: the index of each joint's position."""

    names: Sequence[str] = ()
    length: int = 0  # the number of positions
    places: tuple[tuple[str, int, float, float], ...] = ()  # joint, index, and finite range with slack
    report: JointReport = JointReport()  # the report for positions that are all within their ranges

    @classmethod
    def of(cls, ranges: Ranges, message: JointState, report: JointReport) -> _Plan:
        indices = {name: i for i, name in enumerate(message.name[: len(message.position)]) if name in ranges}
        places = tuple((joint, i, *_with_slack(ranges[joint])) for joint, i in indices.items())
        return cls(list(message.name), len(message.position), places, report._replace(outside=NameList()))

    def positions(self, received: Sequence[float]) -> dict[str, float] | None:
        """Return the position of each joint; None if any position is out of range."""
        found = {}
        for joint, i, low, high in self.places:
            found[joint] = position = received[i]
            if not low <= position <= high:
                return None
        return found


def _ranges(joints: Ranges | Iterable[str]) -> Ranges:
    return joints if isinstance(joints, Mapping) else dict.fromkeys(joints, (-inf, inf))


def _with_slack(limits: tuple[float, float]) -> tuple[float, float]:
    return max(limits[0] - SLACK, -SHOWABLE), min(limits[1] + SLACK, SHOWABLE)
