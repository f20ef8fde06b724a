"""Matching joints by name: the second of the two ideas that the tutorial is about.

In a ``sensor_msgs/JointState`` the names identify the joints; position, velocity and effort are each as long as
``name``, or empty. A viewer that takes "the i-th entry is my i-th joint" for granted shows nothing, or the wrong
thing, as soon as a publisher sends its joints in another order, or only some of them.

`match_joints` is the idea. `JointMatcher` adds what only several messages tell: late ones, and other publishers.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import Enum
from math import inf, isfinite
from typing import TYPE_CHECKING, NamedTuple

from tutorial.errors import did_you_mean

if TYPE_CHECKING:
    from sensor_msgs.msg import JointState

NAMES_KEPT = 3  # in each part of a report, so that it stays small whatever comes in
SECOND_NS = 1_000_000_000  # a stamp that steps back further than this is a publisher that was started again
PAUSE_NS = 10 * SECOND_NS  # that a publisher may make, where there are two
SHOWABLE = 1e9  # [rad or m] nothing moves further; single precision, with which views draw, still holds its square
SLACK = 1e-3  # [rad or m] beyond a range that is not worth a word: simulated limits are soft
REACH, SPEED = 0.1, 5.0  # [rad, rad/s] or [m, m/s]: how far joints with limits get between two messages, at most
LOOK_EVERY = 10  # messages from one look at how many publish to the next
SILENT_AFTER = 25  # messages in a row from each of the others: then the publisher that was followed is silent

Ranges = Mapping[str, tuple[float, float]]


def match_joints(joints: Ranges | Iterable[str], message: JointState) -> tuple[dict[str, float], JointReport]:
    """Find out which joint one message moves where.

    Args:
        joints: the names of a body's joints, or a mapping from each to its range ``(lower, upper)`` [rad or m].
        message: what came in; nothing is assumed about it but its type.

    Returns:
        The positions by joint [rad or m], to be applied as they are, and the report. A joint is missing from the
        positions when the message says nothing usable about it; then it stays where it is. If it is named more than
        once, the last number that can be shown counts.
    """
    ranges = _ranges(joints)
    names, positions = message.name, message.position
    known = [(name, position) for name, position in zip(names, positions) if name in ranges]
    received = dict(known) | {name: q for name, q in known if abs(q) <= SHOWABLE}  # of twins, the last that is fit
    shown = {joint: position for joint, position in received.items() if abs(position) <= SHOWABLE}  # NaN is not
    strange = [name for name in names if name not in ranges]
    named = Counter(name for name, _ in known)
    limits = {joint: _widened(ranges[joint]) for joint in shown}
    return shown, JointReport(
        joints=tuple(shown),
        unknown=NameList.of(strange),
        duplicate=NameList.of([joint for joint, count in named.items() if count > 1]),
        short=max(len(names) - len(positions), 0) if len(positions) else 0,
        long=max(len(positions) - len(names), 0),
        non_finite=NameList.of([joint for joint, position in received.items() if not isfinite(position)]),
        huge=NameList.of([joint for joint, position in received.items() if SHOWABLE < abs(position) < inf]),
        outside=NameList.of([joint for joint, (low, high) in limits.items() if not low <= shown[joint] <= high]),
        known=tuple(ranges) if strange else (),
    )


class NameList(NamedTuple):
    """Names that have something in common: how many there are, and the first few of them."""

    total: int = 0
    names: tuple[str, ...] = ()

    @classmethod
    def of(cls, names: Sequence[str]) -> NameList:
        """Count the names and keep a few, each cut to a bearable length."""
        return cls(len(names), tuple(name[:40] for name in names[:NAMES_KEPT])) if names else cls()

    def __str__(self) -> str:
        more = f" and {self.total - len(self.names)} more" if self.total > len(self.names) else ""
        return ", ".join(map(repr, self.names)) + more


class Arrival(Enum):
    """How a message follows the ones before, and what is said of it."""

    NEXT = ""  #: it is the next one of its publisher
    LATE = "a late message was dropped"  #: it was older than the last one
    ANOTHER = "a message of another publisher was dropped"  #: not of the one that is followed
    RESTARTED = "the publisher was started again"  #: its stamp steps far back
    SWITCHED = "the publisher was started again, or fell silent and another one is followed"  #: from now on


class JointReport(NamedTuple):
    """What was made of one message."""

    joints: tuple[str, ...] = ()  #: those that got a position
    arrival: Arrival = Arrival.NEXT
    unknown: NameList = NameList()  #: names that are no joints of the body
    duplicate: NameList = NameList()  #: joints that were named more than once; the last number that can be shown won
    short: int = 0  #: how many names came without a position
    long: int = 0  #: how many positions came without a name
    non_finite: NameList = NameList()  #: joints whose position was NaN or infinite; they keep their last good value
    huge: NameList = NameList()  #: joints whose position was beyond 1e9, too large to be shown; they keep theirs, too
    outside: NameList = NameList()  #: joints whose position is outside their range; they are shown as received
    known: tuple[str, ...] = ()  #: the joints of the body, if a name is unknown

    @property
    def dropped(self) -> bool:
        """Whether the message moved nothing: it was late, or of another publisher."""
        return self.arrival in (Arrival.LATE, Arrival.ANOTHER)

    @property
    def clean(self) -> bool:
        """Whether there is nothing to complain about."""
        return self[1:-1] == JointReport()[1:-1]

    def counts(self) -> dict[str, int]:
        """How many joints or names there are of each kind: numbers that may be summed up over many messages."""
        arrivals = {each.name.lower(): int(each is self.arrival) for each in Arrival if each is not Arrival.NEXT}
        kinds = ((kind, getattr(self, kind)) for kind in self._fields[2:-1])
        found = {kind: each.total if isinstance(each, NameList) else each for kind, each in kinds}
        return {"matched": len(self.joints), **arrivals, **found}

    def __str__(self) -> str:
        """One line for the log and for below the 3D view."""
        if self.dropped:
            return self.arrival.value
        shown = f"{len(self.joints)} joint{'s' * (len(self.joints) != 1)} shown"
        if self.clean:
            return shown
        hint = did_you_mean(self.unknown.names[0], self.known) if self.unknown.total else ""
        complaints = (
            (self.arrival.value, self.arrival.value),
            (self.unknown.total, f"unknown {self.unknown}.{hint}"),
            (self.duplicate.total, f"named twice, the last number wins: {self.duplicate}"),
            (self.short, f"no position for the last {'name' if self.short == 1 else f'{self.short} names'}"),
            (self.long, f"more positions than names, by {self.long}"),
            (self.non_finite.total, f"not a finite number: {self.non_finite}"),
            (self.huge.total, f"too far to be shown: {self.huge}"),
            (self.outside.total, f"outside its range: {self.outside}"),
        )
        return "; ".join([shown, *(text for found, text in complaints if found)])

    def __repr__(self) -> str:
        return f"JointReport({str(self)!r})"


class JointMatcher:
    """Finds out which joint each message of one topic moves where. No thread, no clock.

    It combines three checks. `match_joints` matches the names. The stamp tells a late message, which is dropped, from
    a publisher that was started again. If several publish, one is followed.

    Args:
        joints: the names of the body's joints, or a mapping from each to its range ``(lower, upper)`` [rad or m]. They
            are copied: for joints that have changed, make another matcher.
        publishers: returns how many publish on the topic, such as a subscription's ``get_publisher_count``.
    """

    def __init__(self, joints: Ranges | Iterable[str], publishers: Callable[[], int] = lambda: 1) -> None:
        self._ranges = dict(_ranges(joints))
        self._plan = _Plan()
        self._newest_ns = -inf  # the stamp of the last message that was shown
        self._followed = _FollowedPublisher(self._ranges, publishers)

    def match(self, message: JointState) -> tuple[dict[str, float], JointReport]:
        """Match the next message.

        Args:
            message: what came in; nothing is assumed about it but its type.

        Returns:
            As `match_joints`, which is asked only when something is new: the usual message costs no search.
        """
        stamp = message.header.stamp
        stamp_ns = stamp.sec * SECOND_NS + stamp.nanosec
        ahead = stamp_ns - self._newest_ns  # always 0 where nobody sets the stamps
        if 0 < ahead <= SECOND_NS or not (ahead or stamp_ns):
            plan = self._plan
            if plan.names != message.name or plan.length != len(message.position):
                plan = self._plan = _Plan.of(self._ranges, message)
            positions = plan.positions(message.position)
            if positions is not None and self._followed.follow_alone(positions):
                self._newest_ns = stamp_ns
                return positions, plan.report
        return self._judge(message, stamp_ns, ahead)

    def _judge(self, message: JointState, stamp_ns: int, ahead: float) -> tuple[dict[str, float], JointReport]:
        """Look closely at a message that is not the usual one: whose it is, whether it is late, and what it holds."""
        positions, report = match_joints(self._ranges, message)
        arrival = self._followed.judge(ahead, positions)
        if arrival is Arrival.NEXT and ahead < 0:  # it is of the one that is followed, so its stamp tells
            arrival = Arrival.LATE if stamp_ns > 0 and ahead >= -SECOND_NS else Arrival.RESTARTED
        report = report._replace(arrival=arrival)
        if report.dropped:
            return {}, JointReport(arrival=arrival)
        self._newest_ns = stamp_ns
        self._followed.follow(positions)
        return positions, report


class _FollowedPublisher:
    """Of the publishers of a topic, the one whose messages are shown.

    A message goes on from the last one shown if its stamp is at most 10 s later, not before, and no joint with limits
    has gone further than it can. Where several publish, what does not go on is another's, and is dropped until only
    such messages have come for a while. If two agree in both, or share no joint, the messages of both are shown.

    Args:
        ranges: of the body's joints.
        count: returns how many publish.
    """

    def __init__(self, ranges: Ranges, count: Callable[[], int]) -> None:
        self._shown: Mapping[str, float] = {}
        self._limited = {joint for joint, (_, upper) in ranges.items() if upper < SHOWABLE}
        self._count = count
        self._others = 0  # publishers besides this one
        self._alone_for = 0  # messages until it is looked whether there are any
        self._dropped = 0  # messages in a row that were another's

    def follow_alone(self, positions: Mapping[str, float]) -> bool:
        """Go on from a usual message and return True, if nobody else publishes; it is looked at every few messages."""
        if not self._alone_for and not self._look():
            return False
        self._alone_for -= 1
        self._shown, self._dropped = positions, 0
        return True

    def judge(self, ahead: float, positions: Mapping[str, float]) -> Arrival:
        """Decide who sent an unusual message, and count it if it is dropped.

        Args:
            ahead: how much later than the last one shown it is stamped [ns].
            positions: what it says.

        Returns:
            ANOTHER if it is to be dropped, SWITCHED if from now on its publisher is followed instead, else NEXT.
        """
        if self._goes_on(ahead, positions):
            return Arrival.NEXT
        self._look()
        dropped = self._dropped + 1
        if dropped > 1 and dropped >= SILENT_AFTER * self._others:
            return Arrival.SWITCHED
        if not self._others:
            return Arrival.NEXT
        self._dropped = dropped
        return Arrival.ANOTHER

    def follow(self, positions: Mapping[str, float]) -> None:
        """Go on from a message that is shown."""
        self._shown, self._dropped = positions, 0

    def _look(self) -> bool:
        self._others = max(self._count() - 1, 0)
        self._alone_for = 0 if self._others else LOOK_EVERY
        return not self._others

    def _goes_on(self, ahead: float, positions: Mapping[str, float]) -> bool:
        reach = REACH + SPEED * ahead / SECOND_NS
        moved = (abs(q - self._shown.get(joint, q)) for joint, q in positions.items() if joint in self._limited)
        return ahead == inf or (0 <= ahead <= PAUSE_NS and max(moved, default=0.0) <= reach)


class _Plan(NamedTuple):
    """What a list of names means for a body's joints. It is the same for every message with these names."""

    names: Sequence[str] = ()  # in the message
    length: int = 0  # how many positions it has
    limits: tuple[tuple[str, float, float], ...] = ()  # each joint that gets one, and its range, with slack and finite
    indices: tuple[int, ...] = ()  # where their positions are; empty when they are the first ones, in order
    report: JointReport = JointReport()  # where every position is within its range

    @classmethod
    def of(cls, ranges: Ranges, message: JointState) -> _Plan:
        """Look every name of a message up."""
        names, length = list(message.name), len(message.position)
        places = {name: i for i, name in enumerate(names[:length]) if name in ranges}
        limits = tuple((joint, *_widened(ranges[joint])) for joint in places)
        _, report = match_joints(ranges, message)
        usual = report._replace(joints=tuple(places), non_finite=NameList(), huge=NameList(), outside=NameList())
        indices = () if list(places.values()) == list(range(len(places))) else tuple(places.values())
        return cls(names, length, limits, indices, usual)

    def positions(self, received: Sequence[float]) -> dict[str, float] | None:
        """Return the position of each joint, or None where one is not within its range."""
        if self.indices:
            received = [received[i] for i in self.indices]
        found = {}
        for (joint, low, high), position in zip(self.limits, received):
            if not low <= position <= high:
                return None
            found[joint] = position
        return found


def _ranges(joints: Ranges | Iterable[str]) -> Ranges:
    return joints if isinstance(joints, Mapping) else dict.fromkeys(joints, (-inf, inf))


def _widened(limits: tuple[float, float]) -> tuple[float, float]:
    """Widen a range by what is not worth a word, and bound it by what can be shown."""
    return max(limits[0] - SLACK, -SHOWABLE), min(limits[1] + SLACK, SHOWABLE)
