"""Matching joints by name: the second of the two ideas that the tutorial is about.

In a ``sensor_msgs/JointState`` the names identify the joints; position, velocity and effort are each as long as
``name``, or empty. A viewer that takes "the i-th entry is my i-th joint" for granted shows nothing, or the wrong
thing, as soon as a publisher sends its joints in another order, or only some of them.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import islice
from math import isfinite
from typing import TYPE_CHECKING, NamedTuple

from tutorial.errors import did_you_mean

if TYPE_CHECKING:
    from sensor_msgs.msg import JointState

__all__ = ["JointReport", "JointTally", "match_joints"]

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


class _Plan(NamedTuple):
    """What a list of names means for a body's joints. It is the same for every message with these names.

    Attributes:
        body: the body's joints, as they were given.
        names: the names in the message.
        length: how many positions the message has.
        joints: those that get a position.
        lows, highs: their ranges, in the same order; the largest finite numbers where there is no limit.
        indices: where their positions are in the message; empty when they are the first ones, in order.
        unknown, duplicate, short: see `JointReport`.
    """

    body: Mapping[str, tuple[float, float]] | Sequence[str]
    names: list[str]
    length: int
    joints: tuple[str, ...]
    lows: tuple[float, ...]
    highs: tuple[float, ...]
    indices: tuple[int, ...]
    unknown: Finding
    duplicate: Finding
    short: int


class JointReport(NamedTuple):
    """What `match_joints` made of one message.

    Attributes:
        matched: how many joints got a position.
        stamp_ns: time stamp of the newest message so far [ns], in the publisher's time.
        non_finite: joints whose position was NaN or infinite; they keep their last good value.
        outside: joints whose position is outside their range; they are shown as received.
        late: the message was older than the one before it, and was dropped.
        restarted: the stamp stepped far back, so the publisher was started again.
    """

    matched: int
    stamp_ns: int
    plan: _Plan
    restarted: bool = False
    late: bool = False
    non_finite: Finding = _NOTHING
    outside: Finding = _NOTHING

    @property
    def unknown(self) -> Finding:
        """Names that are no joints of the body."""
        return self.plan.unknown

    @property
    def duplicate(self) -> Finding:
        """Joints that were named more than once; the last entry won."""
        return self.plan.duplicate

    @property
    def short(self) -> int:
        """How many names came without a position, because the array was shorter than the names."""
        return self.plan.short

    @property
    def clean(self) -> bool:
        """Whether there is nothing to complain about."""
        return not (
            self.late
            or self.restarted
            or self.plan.short
            or self.plan.unknown.total
            or self.plan.duplicate.total
            or self.non_finite.total
            or self.outside.total
        )

    def __str__(self) -> str:
        """One line for the log and for below the 3D view."""
        if self.late:
            return "a late message was dropped"
        return "; ".join([f"{self.matched} joint{'s' * (self.matched != 1)} shown", *self._complaints()])

    def _complaints(self) -> list[str]:
        said = []
        if self.restarted:
            said.append("the publisher was started again")
        if self.unknown.total:
            said.append(f"unknown {self.unknown}.{did_you_mean(self.unknown.names[0], islice(self.plan.body, 8))}")
        if self.duplicate.total:
            said.append(f"named twice, the last wins: {self.duplicate}")
        if self.short:
            said.append(f"no position for the last {'name' if self.short == 1 else f'{self.short} names'}")
        if self.non_finite.total:
            said.append(f"not a finite number: {self.non_finite}")
        if self.outside.total:
            said.append(f"outside its range: {self.outside}")
        return said


def match_joints(
    joints: Mapping[str, tuple[float, float]] | Sequence[str],
    message: JointState,
    after: JointReport | None = None,
) -> tuple[dict[str, float], JointReport]:
    """Find out which joint a message moves where. A pure function: no thread, no clock, no memory but `after`.

    Args:
        joints: the names of the body's joints, or a mapping from each to its range ``(lower, upper)`` [rad or m].
        message: what came in; nothing is assumed about it but its type.
        after: the report of the message before. By its stamp a late message is told from a publisher that was started
            again; and the names that it has looked up need not be looked up again.

    Returns:
        The positions by joint [rad or m], to be applied as they are, and the report. A joint is missing from the
        positions when the message says nothing usable about it; then it stays where it is.
    """
    position = message.position
    plan = after.plan if after is not None else None
    if plan is None or plan.names != message.name or plan.length != len(position) or plan.body is not joints:
        plan = _make_plan(joints, list(message.name), len(position))
    stamp = message.header.stamp
    stamp_ns = stamp.sec * 1_000_000_000 + stamp.nanosec
    restarted = False
    if after is not None and stamp_ns < after.stamp_ns:
        if stamp_ns > 0 and after.stamp_ns - stamp_ns <= LATE_WITHIN_NS:
            return {}, JointReport(0, after.stamp_ns, plan, late=True)
        restarted = True

    if plan.indices:
        position = [position[i] for i in plan.indices]
    values = {}
    usual = True
    for joint, low, high, value in zip(plan.joints, plan.lows, plan.highs, position):
        values[joint] = value
        if not low <= value <= high:
            usual = False
    if usual:
        return values, JointReport(len(values), stamp_ns, plan, restarted)
    finite = {joint: value for joint, value in values.items() if isfinite(value)}
    non_finite = Finding.of([joint for joint in values if joint not in finite])
    return finite, JointReport(len(finite), stamp_ns, plan, restarted, False, non_finite, _outside(plan, finite))


def _outside(plan: _Plan, values: Mapping[str, float]) -> Finding:
    ranges = {joint: (low, high) for joint, low, high in zip(plan.joints, plan.lows, plan.highs)}
    return Finding.of([j for j, value in values.items() if not ranges[j][0] <= value <= ranges[j][1]])


def _make_plan(body: Mapping[str, tuple[float, float]] | Sequence[str], names: list[str], length: int) -> _Plan:
    """Look every name up, once for every list of names: the usual message costs no search."""
    known = set(body)
    positioned = names[:length]
    places = {name: i for i, name in enumerate(positioned) if name in known}  # of twins, the last wins
    indices = tuple(places.values())
    ranges = [body[name] if isinstance(body, Mapping) else (-FINITE, FINITE) for name in places]
    counts = Counter(name for name in positioned if name in known)
    return _Plan(
        body=body,
        names=names,
        length=length,
        joints=tuple(places),
        lows=tuple(max(low - SLACK, -FINITE) for low, _ in ranges),
        highs=tuple(min(high + SLACK, FINITE) for _, high in ranges),
        indices=() if indices == tuple(range(len(indices))) else indices,
        unknown=Finding.of([name for name in names if name not in known]),
        duplicate=Finding.of([name for name, count in counts.items() if count > 1]),
        short=max(len(names) - length, 0) if length else 0,
    )


@dataclass
class JointTally:
    """Sums the reports of a run, for its record.

    Attributes:
        messages: how many messages were applied.
        matched: joints moved, summed over the messages; the other counts likewise.
    """

    messages: int = 0
    matched: int = 0
    unknown: int = 0
    non_finite: int = 0
    short: int = 0
    duplicate: int = 0
    late: int = 0

    def add(self, report: JointReport) -> None:
        """Count one more message."""
        if report.late:
            self.late += 1
            return
        self.messages += 1
        self.matched += report.matched
        self.unknown += report.unknown.total
        self.non_finite += report.non_finite.total
        self.short += report.short
        self.duplicate += report.duplicate.total

    def merge(self, other: JointTally) -> None:
        """Add another tally's counts."""
        for name in (f.name for f in fields(self)):
            setattr(self, name, getattr(self, name) + getattr(other, name))

    def as_dict(self) -> dict[str, int]:
        """Return the counts as they stand in a run's record."""
        return {field.name: getattr(self, field.name) for field in fields(self) if field.name != "messages"}
