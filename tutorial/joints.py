"""Matching joints by name: the second of the two ideas that the tutorial is about.

In a ``sensor_msgs/JointState`` the names identify the joints; position, velocity and effort are each as long as
``name``, or empty. A viewer that takes "the i-th entry is my i-th joint" for granted shows nothing, or the wrong
thing, as soon as a publisher sends its joints in another order, or only some of them.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from math import inf, isfinite
from typing import TYPE_CHECKING, NamedTuple

from tutorial.errors import did_you_mean

if TYPE_CHECKING:
    from sensor_msgs.msg import JointState

__all__ = ["JointMatcher", "JointReport", "match_joints"]

LATE_WITHIN_NS = 1_000_000_000  # a stamp that steps back further than this is a publisher that was started again
FINITE = sys.float_info.max
SLACK = 1e-3  # [rad or m] beyond a range that is not worth a word: simulated limits are soft
NAMES_KEPT = 3  # of each finding, so that a report stays small whatever comes in


class Finding(NamedTuple):
    """Names that have something in common: how many there are, and the first few of them."""

    total: int = 0
    names: tuple[str, ...] = ()

    @classmethod
    def of(cls, names: Sequence[str]) -> Finding:
        """Count the names and keep a few, each cut to a bearable length."""
        return cls(len(names), tuple(name[:40] for name in names[:NAMES_KEPT])) if names else _NOTHING

    def __str__(self) -> str:
        more = f" and {self.total - len(self.names)} more" if self.total > len(self.names) else ""
        return ", ".join(map(repr, self.names)) + more


_NOTHING = Finding()


class JointReport(NamedTuple):
    """What was made of one message.

    Attributes:
        matched: how many joints got a position.
        late: the message was older than one before it, and was dropped.
        restarted: the stamp stepped far back, so the publisher was started again.
        unknown: names that are no joints of the body.
        duplicate: joints that were named more than once; the last entry won.
        short: how many names came without a position, because the array was shorter than the names.
        non_finite: joints whose position was NaN or infinite; they keep their last good value.
        outside: joints whose position is outside their range; they are shown as received.
        known: where names are unknown, the first few that are not.
    """

    matched: int
    late: bool = False
    restarted: bool = False
    unknown: Finding = _NOTHING
    duplicate: Finding = _NOTHING
    short: int = 0
    non_finite: Finding = _NOTHING
    outside: Finding = _NOTHING
    known: tuple[str, ...] = ()

    @property
    def clean(self) -> bool:
        """Whether there is nothing to complain about."""
        counts = (found.total for found in (self.unknown, self.duplicate, self.non_finite, self.outside))
        return not (self.late or self.restarted or self.short or any(counts))

    def counts(self) -> dict[str, int]:
        """How many joints or names there are of each kind: numbers that may be summed up over many messages."""
        return {
            "matched": self.matched,
            "unknown": self.unknown.total,
            "non_finite": self.non_finite.total,
            "short": self.short,
            "duplicate": self.duplicate.total,
            "late": int(self.late),
        }

    def __str__(self) -> str:
        """One line for the log and for below the 3D view."""
        if self.late:
            return "a late message was dropped"
        return "; ".join([f"{self.matched} joint{'s' * (self.matched != 1)} shown", *self._complaints()])

    def __repr__(self) -> str:
        return f"JointReport({str(self)!r})"

    def _complaints(self) -> list[str]:
        said = []
        if self.restarted:
            said.append("the publisher was started again")
        if self.unknown.total:
            said.append(f"unknown {self.unknown}.{did_you_mean(self.unknown.names[0], self.known)}")
        if self.duplicate.total:
            said.append(f"named twice, the last wins: {self.duplicate}")
        if self.short:
            said.append(f"no position for the last {'name' if self.short == 1 else f'{self.short} names'}")
        if self.non_finite.total:
            said.append(f"not a finite number: {self.non_finite}")
        if self.outside.total:
            said.append(f"outside its range: {self.outside}")
        return said


_LATE = JointReport(matched=0, late=True)


class _Plan(NamedTuple):
    """What a list of names means for a body's joints. It is the same for every message with these names.

    Attributes:
        names: the names in the message.
        length: how many positions the message has.
        joints: those that get a position.
        lows, highs: their limits, in the same order.
        indices: where their positions are in the message; empty when they are the first ones, in order.
        usual: the report, where every position is within the limits.
    """

    names: list[str]
    length: int
    joints: tuple[str, ...]
    lows: tuple[float, ...]
    highs: tuple[float, ...]
    indices: tuple[int, ...]
    usual: JointReport


_NO_NAMES = _Plan([], 0, (), (), (), (), JointReport(matched=0))


class JointMatcher:
    """Finds out which joint each message of one topic moves where.

    It remembers the newest stamp, by which a late message is told from a publisher that was started again; and what
    the last list of names meant, so that the usual message costs no search. No thread, no clock.

    Args:
        joints: the names of the body's joints, or a mapping from each to its range ``(lower, upper)`` [rad or m]. They
            are copied: for joints that have changed, make another matcher.
    """

    def __init__(self, joints: Mapping[str, tuple[float, float]] | Iterable[str]) -> None:
        ranges = joints if isinstance(joints, Mapping) else dict.fromkeys(joints, (-inf, inf))
        self._limits = {  # finite, so that what is not finite is not within them
            name: (max(low - SLACK, -FINITE), min(high + SLACK, FINITE)) for name, (low, high) in ranges.items()
        }
        self._plan = _NO_NAMES
        self._stamp_ns = -inf  # of the newest message so far, in the publisher's time

    def match(self, message: JointState) -> tuple[dict[str, float], JointReport]:
        """Match the next message.

        Args:
            message: what came in; nothing is assumed about it but its type.

        Returns:
            The positions by joint [rad or m], to be applied as they are, and the report. A joint is missing from the
            positions when the message says nothing usable about it; then it stays where it is.
        """
        stamp = message.header.stamp
        stamp_ns = stamp.sec * 1_000_000_000 + stamp.nanosec
        restarted = stamp_ns < self._stamp_ns
        if restarted and stamp_ns > 0 and self._stamp_ns - stamp_ns <= LATE_WITHIN_NS:
            return {}, _LATE
        self._stamp_ns = stamp_ns

        position = message.position
        plan = self._plan
        if plan.names != message.name or plan.length != len(position):
            plan = self._plan = self._make_plan(list(message.name), len(position))
        if plan.indices:
            position = [position[i] for i in plan.indices]
        values = {}
        usual = not restarted
        for joint, low, high, value in zip(plan.joints, plan.lows, plan.highs, position):
            values[joint] = value
            if not low <= value <= high:
                usual = False
        if usual:
            return values, plan.usual
        finite = {joint: value for joint, value in values.items() if isfinite(value)}
        return finite, plan.usual._replace(
            matched=len(finite),
            restarted=restarted,
            non_finite=Finding.of([joint for joint in values if joint not in finite]),
            outside=Finding.of([joint for joint, value in finite.items() if not self._within(joint, value)]),
        )

    def _within(self, joint: str, value: float) -> bool:
        low, high = self._limits[joint]
        return low <= value <= high

    def _make_plan(self, names: list[str], length: int) -> _Plan:
        """Look every name up, once for every list of names."""
        known = [(name, i) for i, name in enumerate(names[:length]) if name in self._limits]
        places = dict(known)  # of twins, the last wins
        indices = tuple(places.values())
        limits = [self._limits[name] for name in places]
        counts = Counter(name for name, _ in known)
        unknown = Finding.of([name for name in names if name not in self._limits])
        return _Plan(
            names=names,
            length=length,
            joints=tuple(places),
            lows=tuple(low for low, _ in limits),
            highs=tuple(high for _, high in limits),
            indices=() if indices == tuple(range(len(indices))) else indices,
            usual=JointReport(
                matched=len(places),
                unknown=unknown,
                duplicate=Finding.of([name for name, count in counts.items() if count > 1]),
                short=max(len(names) - length, 0) if length else 0,
                known=tuple(islice(self._limits, 8)) if unknown.total else (),
            ),
        )


def match_joints(
    joints: Mapping[str, tuple[float, float]] | Iterable[str], message: JointState
) -> tuple[dict[str, float], JointReport]:
    """Find out which joint one message moves where. A pure function: it knows of no message before.

    Args:
        joints: as for `JointMatcher`.
        message: as for `JointMatcher.match`, as is what is returned.
    """
    return JointMatcher(joints).match(message)
