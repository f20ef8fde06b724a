"""Matching joints by name: the second of the two ideas that the tutorial is about.

In a ``sensor_msgs/JointState`` the names identify the joints; position, velocity and effort are each as long as
``name``, or empty. A viewer that takes "the i-th entry is my i-th joint" for granted shows nothing, or the wrong
thing, as soon as a publisher sends its joints in another order, or only some of them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import islice
from math import inf, isfinite
from typing import TYPE_CHECKING, NamedTuple

from tutorial.errors import did_you_mean

if TYPE_CHECKING:
    from sensor_msgs.msg import JointState

__all__ = ["JointMatcher", "JointReport", "match_joints"]

NAMES_KEPT = 3  # of each finding, so that a report stays small whatever comes in
MOST_NAMES = 10_000  # that are looked up, of one message
SECOND_NS = 1_000_000_000  # a stamp that steps back further than this is a publisher that was started again
PAUSE_NS = 10 * SECOND_NS  # that a publisher may make, where there are two
SHOWABLE = 1e9  # [rad or m] nothing moves further; single precision, with which views draw, still holds its square
SLACK = 1e-3  # [rad or m] beyond a range that is not worth a word: simulated limits are soft
REACH, SPEED = 0.1, 5.0  # [rad, rad/s] or [m, m/s]: how far joints with limits get between two messages, at most
LOOK_EVERY = 10  # messages from one look at how many publish to the next
SILENT_AFTER = 25  # messages in a row from each of the others: then the publisher that was followed is silent


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


class JointReport(NamedTuple):
    """What was made of one message."""

    joints: tuple[str, ...] = ()  #: those that got a position
    late: bool = False  #: the message was older than the last one, and was dropped
    another: bool = False  #: the message was not of the publisher that is followed, and was dropped
    restarted: bool = False  #: the stamp stepped far back, so the publisher was started again
    switched: bool = False  #: of several, the one that was followed has fallen silent; from now on this one is followed
    unknown: NameList = NameList()  #: names that are no joints of the body, or come after ten thousand others
    duplicate: NameList = NameList()  #: joints that were named more than once; the last entry won
    short: int = 0  #: how many names came without a position
    long: int = 0  #: how many positions came without a name
    non_finite: NameList = NameList()  #: joints whose position was NaN or infinite; they keep their last good value
    huge: NameList = NameList()  #: joints whose position was too large to be shown, beyond 1e9; they keep theirs
    outside: NameList = NameList()  #: joints whose position is outside their range; they are shown as received
    known: tuple[str, ...] = ()  #: where names are unknown, the first few that are not

    @property
    def matched(self) -> int:
        """How many joints got a position."""
        return len(self.joints)

    @property
    def clean(self) -> bool:
        """Whether there is nothing to complain about."""
        return self[1:-1] == JointReport()[1:-1]

    def counts(self) -> dict[str, int]:
        """How many joints or names there are of each kind: numbers that may be summed up over many messages."""
        kinds = ((kind, getattr(self, kind)) for kind in self._fields[1:-1])
        found = {kind: each.total if isinstance(each, NameList) else int(each) for kind, each in kinds}
        return {"matched": self.matched, **found}

    def __str__(self) -> str:
        """One line for the log and for below the 3D view."""
        if self.late or self.another:
            return f"a {'late message' if self.late else 'message of another publisher'} was dropped"
        shown = f"{self.matched} joint{'s' * (self.matched != 1)} shown"
        if self.clean:
            return shown
        hint = did_you_mean(self.unknown.names[0], self.known) if self.unknown.total else ""
        complaints = (
            (self.restarted, "the publisher was started again"),
            (self.switched, "the publisher was started again, or fell silent and another one is followed"),
            (self.unknown.total, f"unknown {self.unknown}.{hint}"),
            (self.duplicate.total, f"named twice, the last wins: {self.duplicate}"),
            (self.short, f"no position for the last {'name' if self.short == 1 else f'{self.short} names'}"),
            (self.long, f"more positions than names, by {self.long}"),
            (self.non_finite.total, f"not a finite number: {self.non_finite}"),
            (self.huge.total, f"too far to be shown: {self.huge}"),
            (self.outside.total, f"outside its range: {self.outside}"),
        )
        return "; ".join([shown, *(text for found, text in complaints if found)])

    def __repr__(self) -> str:
        return f"JointReport({str(self)!r})"


class _Plan(NamedTuple):
    """What a list of names means for a body's joints. It is the same for every message with these names."""

    names: list[str]  # in the message
    length: int  # how many positions it has
    joints: tuple[str, ...]  # those that get a position
    lows: tuple[float, ...]  # their limits, in the same order
    highs: tuple[float, ...]
    indices: tuple[int, ...]  # where their positions are in the message; empty when they are the first ones, in order
    usual: JointReport  # where every position is within the limits


class JointMatcher:
    """Finds out which joint each message of one topic moves where.

    It remembers the newest stamp, by which a late message is told from a publisher that was started again; and what
    the last list of names meant, so that the usual message costs no search. No thread, no clock.

    Where several publish, it follows one: what doesn't go on from the last message shown is another's, and is dropped
    until only such messages have come for a while. A message goes on if its stamp is at most 10 s later, not before,
    and no joint with limits has gone further than it can. Two alike in both, or that share no joint, are both shown.

    Args:
        joints: the names of the body's joints, or a mapping from each to its range ``(lower, upper)`` [rad or m]. They
            are copied: for joints that have changed, make another matcher.
        publishers: returns how many publish on the topic, such as a subscription's ``get_publisher_count``.
    """

    def __init__(
        self, joints: Mapping[str, tuple[float, float]] | Iterable[str], publishers: Callable[[], int] = lambda: 1
    ) -> None:
        ranges = joints if isinstance(joints, Mapping) else dict.fromkeys(joints, (-inf, inf))
        self._limits = {  # finite, so that what is not finite is not within them
            name: (max(low - SLACK, -SHOWABLE), min(high + SLACK, SHOWABLE)) for name, (low, high) in ranges.items()
        }
        self._plan = self._make_plan([], 0)
        self._stamp_ns = -inf  # of the last message that was shown, in its publisher's time
        self._shown: Mapping[str, float] = {}  # its positions
        self._publishers = publishers
        self._others = 0  # publishers besides the one that is followed
        self._alone_for = 0  # messages until it is looked whether there are any
        self._dropped = 0  # messages in a row that were another's

    def match(self, message: JointState) -> tuple[dict[str, float], JointReport]:
        """Match the next message.

        Args:
            message: what came in; nothing is assumed about it but its type.

        Returns:
            The positions by joint [rad or m], to be applied as they are, and the report. A joint is missing from the
            positions when the message says nothing usable about it; then it stays where it is.
        """
        stamp = message.header.stamp
        stamp_ns = stamp.sec * SECOND_NS + stamp.nanosec
        position = message.position
        plan = self._plan
        if plan.names != message.name or plan.length != len(position):
            plan = self._plan = self._make_plan(list(message.name), len(position))
        if plan.indices:
            position = [position[i] for i in plan.indices]
        values = {}
        usual = True
        for joint, low, high, value in zip(plan.joints, plan.lows, plan.highs, position):
            values[joint] = value
            if not low <= value <= high:
                usual = False
        alone_for = self._alone_for or self._look()
        ahead = stamp_ns - self._stamp_ns  # always 0 where nobody sets the stamps
        if usual and alone_for and (0 < ahead <= SECOND_NS or not (ahead or stamp_ns)):
            self._alone_for = alone_for - 1
            self._stamp_ns = stamp_ns
            self._shown = values
            return values, plan.usual
        return self._judge(stamp_ns, values, plan)

    def _look(self) -> int:
        """Ask how many publish. Returns for how many messages one alone is believed to, so 0 if there are more."""
        self._others = max(self._publishers() - 1, 0)
        self._alone_for = 0 if self._others else LOOK_EVERY
        return self._alone_for

    def _judge(self, stamp_ns: int, values: dict[str, float], plan: _Plan) -> tuple[dict[str, float], JointReport]:
        """Look closely at a message that is not the usual one: whose it is, and which positions can be shown."""
        shown = {joint: value for joint, value in values.items() if abs(value) <= SHOWABLE}  # NaN is not
        ahead = stamp_ns - self._stamp_ns
        goes_on = self._goes_on(ahead, shown)
        if not goes_on:
            self._look()
        another = self._others > 0 and not goes_on
        dropped = self._dropped + 1
        switched = not goes_on and dropped > 1 and dropped >= SILENT_AFTER * self._others
        if another and not switched:
            self._dropped = dropped
            return {}, JointReport(another=True)
        if stamp_ns > 0 > ahead >= -SECOND_NS and not switched:
            return {}, JointReport(late=True)
        self._stamp_ns, self._shown, self._dropped = stamp_ns, shown, 0
        limits = zip(plan.joints, plan.lows, plan.highs)
        return shown, plan.usual._replace(
            joints=tuple(shown),
            restarted=ahead < 0 and not switched,
            switched=switched,
            non_finite=NameList.of([joint for joint in values if not isfinite(values[joint])]),
            huge=NameList.of([joint for joint in values if joint not in shown and isfinite(values[joint])]),
            outside=NameList.of([joint for joint, low, high in limits if not low <= shown.get(joint, low) <= high]),
        )

    def _goes_on(self, ahead: float, positions: dict[str, float]) -> bool:
        """Whether a message may be the next one of the publisher that is followed, so many nanoseconds later."""
        reach = REACH + SPEED * ahead / SECOND_NS
        moved = (
            abs(q - self._shown.get(joint, q)) for joint, q in positions.items() if self._limits[joint][1] < SHOWABLE
        )
        return ahead == inf or (0 <= ahead <= PAUSE_NS and max(moved, default=0.0) <= reach)

    def _make_plan(self, names: list[str], length: int) -> _Plan:
        """Look every name up, once for every list of names."""
        known = [(name, i) for i, name in enumerate(names[: min(length, MOST_NAMES)]) if name in self._limits]
        places = dict(known)  # of twins, the last wins
        twins = [name for name, count in Counter(name for name, _ in known).items() if count > 1]
        strange = [name for name in names[:MOST_NAMES] if name not in self._limits] + names[MOST_NAMES:]
        usual = JointReport(
            joints=tuple(places),
            unknown=NameList.of(strange),
            duplicate=NameList.of(twins),
            short=max(len(names) - length, 0) if length else 0,
            long=max(length - len(names), 0),
            known=tuple(islice(self._limits, 8)) if strange else (),
        )
        lows, highs = (tuple(self._limits[name][end] for name in places) for end in (0, 1))
        indices = () if list(places.values()) == list(range(len(places))) else tuple(places.values())
        return _Plan(names, length, usual.joints, lows, highs, indices, usual)


def match_joints(
    joints: Mapping[str, tuple[float, float]] | Iterable[str], message: JointState
) -> tuple[dict[str, float], JointReport]:
    """Find out which joint one message moves where, as `JointMatcher` does, but knowing of no message before."""
    return JointMatcher(joints).match(message)
