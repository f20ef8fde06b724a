"""Looking at an answer to `by_name`: messages as they come, and as they should not."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import inf, isnan, nan
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.checks._answer import name_of
from tutorial.checks._diagnose import Misuse, sentence
from tutorial.checks._explain import Mistake
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Failure, watch

__all__ = ["judge_match"]

BODY = ("TURRET_Y", "TURRET_P", "HATCH")
CRANE = ("SLEW", "BRIDGE", "LUFF")


@dataclass(frozen=True)
class _Case:
    """One message.

    Attributes:
        label: what it is like.
        names, positions: what it says.
        body: the names of the body's joints.
        optional: a joint that may be there or not.
        crash: the most likely cause when something is raised.
        otherwise: the most likely cause of a wrong answer that nothing known explains.
    """

    label: str
    names: Sequence[str]
    positions: Sequence[float]
    crash: str
    otherwise: str
    body: Sequence[str] = BODY
    optional: str = ""

    def message(self) -> JointState:
        """Make the message."""
        return JointState(name=list(self.names), position=list(self.positions))


LIKELY = "Most likely "
BY_PLACE = (
    "Most likely positions are matched by their place: the i-th position belongs to the i-th name of the message."
)
NO_SUBSET = "Most likely every joint is expected in every message: go through the message's names, not the body's."
UNKNOWN = "Most likely names that the body does not have are kept: leave them out, if name in joint_names."
UNKNOWN_CRASH = "Most likely a name is looked up that the body does not have: ask first, if name in joint_names."
SHORT_CRASH = (
    "Most likely there is an index beyond the end, or zip with strict=True: zip(message.name, message.position) alone "
    "ends with the shorter."
)
SHORT = "Most likely fewer positions than names are not expected: those that are there count."
LONG = "Most likely more positions than names are not expected: those without a name say nothing, the others count."
EMPTY = "Most likely an empty array is not expected: it says nothing about the pose, so return {}."
NAN = "Most likely NaN is not left out as it should be: only that joint, and math.isfinite tells."
INFINITE = "Most likely infinity is not expected: whatever is made of it, the other joints count."
TWINS_CAUSE = "Most likely a name that comes twice is not expected: the last one counts, as in dict(pairs)."
EXACT = "Most likely names are compared in part, or changed first: a joint's name is the whole of it, as it is written."
ZERO = "Most likely 0.0 is taken for nothing, as in `if position`: it is a position like any other."
TYPED = "Most likely the joints' names are typed: those of the body are in joint_names."
COMPARE = "Compare with: the i-th position belongs to the i-th name, if the body has that name and it is not NaN."
NOT_A_DICT = "Return a dict from names to positions, an empty one when there is nothing to tell."
NO_RETURN = "Most likely return is missing: give the dict back, an empty one when there is nothing to tell."
PAIRS = "A dict was asked for, from names to positions: dict(pairs) makes one of pairs."
SWAPPED = (
    "Most likely names and positions are exchanged in the dict: it goes from names to positions, {name: position}."
)
NONES = "Most likely a joint that the message says nothing about gets None: leave it out of the dict."
CHANGED = "Most likely pop, sort, remove or an assignment changes the message itself: leave it as it is, take a copy."
CHANGED_NAMES = "Most likely joint_names is changed: it belongs to the caller, take a copy."
KEPT = "Most likely the dict is kept from call to call: make a new one in every call, and not as a default argument."

CASES = (
    _Case("all joints, in order", BODY, (0.1, 0.2, 0.3), NO_SUBSET, COMPARE),
    _Case("another order", BODY[::-1], (0.3, 0.2, 0.1), BY_PLACE, BY_PLACE),
    _Case("only HATCH", ("HATCH",), (0.3,), NO_SUBSET, NO_SUBSET),
    _Case("an unknown name, ANTENNA", ("ANTENNA", "TURRET_P", "HATCH"), (0.9, 0.2, 0.3), UNKNOWN_CRASH, UNKNOWN),
    _Case("3 names, 2 positions", BODY, (0.1, 0.2), SHORT_CRASH, SHORT),
    _Case("no positions", BODY, (), EMPTY, EMPTY),
    _Case("NaN for TURRET_P", BODY, (0.1, nan, 0.3), NAN, NAN),
    _Case("TURRET_Y twice", ("TURRET_Y", "TURRET_P", "TURRET_Y"), (0.1, 0.2, 0.3), TWINS_CAUSE, TWINS_CAUSE),
    _Case("TURRET_Y twice, and smaller", ("TURRET_Y", "TURRET_Y", "HATCH"), (0.3, 0.1, 0.2), TWINS_CAUSE, TWINS_CAUSE),
    _Case("TURRET_Y at 0, HATCH below", BODY, (0.0, 0.2, -0.3), ZERO, ZERO),
    _Case("an unknown name in the middle", ("HATCH", "ANTENNA", "TURRET_Y"), (0.3, 0.9, 0.1), UNKNOWN_CRASH, UNKNOWN),
    _Case("NaN for TURRET_Y, the first", ("TURRET_Y", "HATCH"), (nan, 0.3), NAN, NAN),
    _Case("NaN for HATCH, the last", BODY, (0.1, 0.2, nan), NAN, NAN),
    _Case("NaN for all", BODY, (nan, nan, nan), NAN, NAN),
    _Case("NaN for the unknown ANTENNA", ("ANTENNA", "HATCH"), (nan, 0.3), NAN, UNKNOWN),
    _Case("infinity for TURRET_P", BODY, (0.1, inf, 0.3), INFINITE, INFINITE, optional="TURRET_P"),
    _Case("TURRET_Y twice, at first NaN", ("TURRET_Y", "HATCH", "TURRET_Y"), (nan, 0.3, 0.1), TWINS_CAUSE, TWINS_CAUSE),
    _Case("an empty message", (), (), EMPTY, EMPTY),
    _Case("2 names, 3 positions", BODY[:2], (0.1, 0.2, 0.3), LONG, LONG),
    _Case(
        "names that are almost right",
        ("turret_y", "Tank/TURRET_P", " HATCH", "TURRET", "", "HATCH_2"),
        (0.1, 0.2, 0.3, 0.4, 0.5, 0.6),
        UNKNOWN_CRASH,
        EXACT,
    ),
    _Case("the crane's joints", ("LUFF", "HATCH", "SLEW"), (0.3, 0.9, 0.123456), TYPED, TYPED, CRANE),
    _Case("a body with one joint", ("TURRET_P", "HATCH"), (0.2, 0.3), TYPED, TYPED, ("HATCH",)),
)

MISTAKES = (
    Mistake("pairs", "place", BY_PLACE[len("Most likely ") :]),
    Mistake(
        "pairs",
        "place and name",
        "the i-th joint of the body is compared with the i-th name of the message: look for the name wherever it is.",
    ),
    Mistake(
        "pairs",
        "known first",
        "unknown names are left out before names and positions are paired, so the positions move up to other names: "
        "zip both as they come, and leave out pairs.",
    ),
    Mistake(
        "pairs",
        "numbers first",
        "NaN is left out before names and positions are paired, so the positions move up to other names: zip both as "
        "they come, and leave out pairs.",
    ),
    Mistake(
        "pairs",
        "both first",
        "unknown names and NaN are left out before names and positions are paired, so they belong to others: zip both "
        "as they come, and leave out pairs.",
    ),
    Mistake(
        "pairs", "sorted names", "the names are sorted, and the positions are not: they belong together as they come."
    ),
    Mistake("pairs", "from the end", "names and positions are paired from the end: the first belongs to the first."),
    Mistake("unknown", "kept", UNKNOWN.removeprefix(LIKELY)),
    Mistake("unknown", "stop", "the loop ends at an unknown name: leave out only that one and go on, continue."),
    Mistake("unknown", "all", "an unknown name makes the whole message invalid: leave out only that one."),
    Mistake("unknown", "case", "upper and lower case are taken for the same: turret_y is another name than TURRET_Y."),
    Mistake("unknown", "suffix", "only the end of a name is compared: Tank/TURRET_P is another name than TURRET_P."),
    Mistake("unknown", "cut", "blanks around a name are cut off: it is another name then."),
    Mistake(
        "unknown", "part", "a part of a name is enough, as in `in` between two texts: it has to be the whole name."
    ),
    Mistake(
        "nan",
        "kept",
        "NaN is passed on: leave out what is not finite, math.isfinite tells (NaN == NaN is False).",
    ),
    Mistake("nan", "stop", "the loop ends at NaN: leave out only that joint and go on, continue."),
    Mistake("nan", "all", "one NaN makes the whole message invalid: leave out only that joint."),
    Mistake("nan", "zero", "NaN becomes 0: leave the joint out, then it stays where it is."),
    Mistake("twins", "first", "the first of two of the same name wins: the last one does, as in dict(pairs)."),
    Mistake(
        "twins",
        "largest",
        "of two of the same name the largest position wins, as when pairs are sorted: the last "
        "one does, in the message's order.",
    ),
    Mistake(
        "twins",
        "smallest",
        "of two of the same name the smallest position wins, as when pairs are sorted: the "
        "last one does, in the message's order.",
    ),
    Mistake("twins", "none", "a name that comes twice is left out altogether: the last one counts."),
    Mistake("twins", "no name", "a name that comes twice is left out altogether: the last one counts."),
    Mistake("twins", "first name", "the first of two of the same name counts, as with index: the last one does."),
    Mistake("twins", "mean", "the positions of two of the same name are averaged: the last one counts."),
    Mistake("twins", "sum", "the positions of two of the same name are added: the last one counts."),
    Mistake("short", "none", "a message with fewer positions is dropped as a whole: use those that are there."),
    Mistake("short", "zero", "a name without a position is set to 0: leave it out, then the joint stays where it is."),
    Mistake("short", "last", "a name without a position gets the last one there is: leave it out."),
    Mistake("long", "none", "a message with more positions than names is dropped as a whole: use the pairs there are."),
    Mistake("absent", "zero", "a joint without a position is set to 0: leave it out, then it stays where it is."),
    Mistake("absent", "nan", "a joint without a position gets NaN: leave it out of the dict."),
    Mistake("absent", "no dict", NO_SUBSET.removeprefix(LIKELY)),
    Mistake("value", "no zero", ZERO.removeprefix(LIKELY)),
    Mistake("value", "positive", "positions below 0 are left out: a joint turns both ways."),
    Mistake("value", "absolute", "the sign is lost: a joint turns both ways."),
    Mistake("value", "degrees", "positions are converted to degrees: they are rad on both sides."),
    Mistake("value", "radians", "positions are converted to rad: they are rad already."),
    Mistake("value", "rounded", "positions are rounded: pass them on as they are."),
    Mistake("body", BODY, TYPED.removeprefix(LIKELY)),
)


@dataclass(frozen=True)
class _Model:
    """An answer that is right but for its mistakes; without arguments it is the right one."""

    pairs: str = "as they come"
    unknown: str = "left out"
    nan: str = "left out"
    twins: str = "last"
    short: str = "those there are"
    long: str = "those there are"
    absent: str = "left out"
    value: str = "as it is"
    body: Sequence[str] = ()

    def answer(self, case: _Case) -> dict[str, float]:
        """Return what it makes of a message."""
        names, positions, body = list(case.names), list(case.positions), self.body or case.body
        if self.short != "those there are" and len(positions) < len(names):
            if self.short == "none" or not positions:
                return dict.fromkeys((name for name in names if name in body), 0.0) if self.short == "zero" else {}
            positions += [0.0 if self.short == "zero" else positions[-1]] * (len(names) - len(positions))
        if self.long == "none" and len(positions) > len(names):
            return {}
        found: dict[str, list[float]] = {}
        for i, (name, position) in enumerate(self._paired(names, positions, body)):
            if (self.twins == "no name" and names.count(name) > 1) or (
                self.twins == "first name" and name in names[:i]
            ):
                continue
            joint = self._joint(name, body)
            bad = (self.nan if isnan(position) else "") or (self.unknown if joint is None else "")
            if bad == "all":
                return {}
            if bad == "stop":
                break
            if joint is None or bad == "left out" or not self._counts(position):
                continue
            found.setdefault(joint, []).append(self._value(position))
        given = {name: self._winner(twins) for name, twins in found.items() if self.twins != "none" or len(twins) == 1}
        if self.absent == "no dict" and set(body) - set(given):
            return {}
        fill = {"zero": 0.0, "nan": nan}.get(self.absent)
        return given if fill is None else {**dict.fromkeys(body, fill), **given}

    def _paired(self, names: list[str], positions: list[float], body: Sequence[str]) -> Iterator[tuple[str, float]]:
        known = [name for name in names if name in body] if self.pairs in ("known first", "both first") else names
        numbers = [q for q in positions if not isnan(q)] if self.pairs in ("numbers first", "both first") else positions
        if self.pairs == "place":
            return zip(body, numbers)
        if self.pairs == "place and name":
            return ((joint, q) for joint, name, q in zip(body, names, positions) if joint == name)
        if self.pairs == "from the end":
            return zip(names[::-1], positions[::-1])
        return zip(sorted(names) if self.pairs == "sorted names" else known, numbers)

    def _joint(self, name: str, body: Sequence[str]) -> str | None:
        """Return the joint that it takes a name for."""
        meant = {"case": name.upper(), "suffix": name.rpartition("/")[2], "cut": name.strip()}.get(self.unknown, name)
        if self.unknown == "part" and any(name in each for each in body):
            return name
        return meant if self.unknown == "kept" or meant in body else None

    def _counts(self, position: float) -> bool:
        no_zero, positive = self.value == "no zero" and position == 0.0, self.value == "positive" and position < 0.0
        return not (no_zero or positive)

    def _value(self, position: float) -> float:
        if isnan(position):
            return 0.0 if self.nan == "zero" else position
        converted = {
            "absolute": abs(position),
            "degrees": math.degrees(position),
            "radians": math.radians(position),
            "rounded": round(position, 3),
        }
        return converted.get(self.value, position)

    def _winner(self, twins: list[float]) -> float:
        chosen = {
            "first": twins[0],
            "largest": max(twins),
            "smallest": min(twins),
            "mean": sum(twins) / len(twins),
            "sum": sum(twins),
        }
        return chosen.get(self.twins, twins[-1])


def judge_match(answer: Callable[[Sequence[str], JointState], Any]) -> Iterator[Finding]:
    """Look at an answer to `by_name`."""
    shared = SharedState(answer)
    seen: list[dict[str, Any] | Failure] = []
    for case in CASES:
        message, names = case.message(), list(case.body)
        try:
            with watch.call(name_of(answer)):
                given = answer(names, message)
        except Failure as failure:
            given = failure
            if isinstance(failure.error, Misuse):
                yield failure.finding()
                return
        odd = _judge_kind(answer, case, given) or _judge_untouched(case, message, names)
        if odd is None and any(given is each for each in seen):
            odd = wrong(f"{case.label}: the same dict is returned as the time before", KEPT)
        if odd is not None:
            yield from _judge_values(seen, shared)
            yield odd
            return
        seen.append(given)
    yield from _judge_values(seen, shared)


def _judge_kind(answer: Any, case: _Case, given: Any) -> Finding | None:
    """Look whether something else is returned than a dict from names to numbers."""
    if isinstance(given, Failure):
        return None
    if not isinstance(given, dict):
        cause = NO_RETURN if given is None else PAIRS if _is_pairs(given) else NOT_A_DICT
        return wrong(f"{case.label}: {name_of(answer)} returns {_called(given)}", cause)
    text = f"{case.label}: {_say(given)}; expected: {_say(_Model().answer(case))}"
    if any(isinstance(name, float) or isinstance(value, str) for name, value in given.items()):
        return wrong(text, SWAPPED)
    if any(value is None for value in given.values()):
        return wrong(text, NONES)
    numbers = all(isinstance(name, str) and _is_number(value) for name, value in given.items())
    return None if numbers else wrong(text, NOT_A_DICT)


def _judge_untouched(case: _Case, message: JointState, names: list[str]) -> Finding | None:
    """Look whether what was given is as it was."""
    if list(message.name) != list(case.names) or repr(list(message.position)) != repr(list(map(float, case.positions))):
        return wrong(f"{case.label}: the message is not the same afterwards", CHANGED)
    if names != list(case.body):
        return wrong(f"{case.label}: joint_names is not the same afterwards", CHANGED_NAMES)
    return None


def _judge_values(seen: Sequence[dict[str, Any] | Failure], shared: SharedState) -> Iterator[Finding]:
    """Compare what was returned with what should have been, and name the mistakes where they show first."""
    fine = [not isinstance(given, Failure) and _is_right(case, given) for case, given in zip(CASES, seen)]
    found = () if all(fine) else _explained(seen)
    otherwise = "" if found else _kept(seen)
    told: list[str] = []
    crashes: dict[object, str] = {}  # by place, the cause that was named first
    for i, (case, given) in enumerate(zip(CASES, seen)):
        if isinstance(given, Failure):
            known = isinstance(given.error, (LookupError, ValueError)) or "NoneType" in sentence(given.error)
            cause = crashes.setdefault(given.place, case.crash)
            yield given.finding(cause if known else None, case.label)
        elif fine[i]:
            yield right(f"{case.label}: {_say(given)}")
        else:
            causes = [f"{LIKELY}{each.cause}" for each in found if not _is_right(case, _by(each).answer(case))]
            cause = next((each for each in causes if each not in told), "")
            if cause or not causes:
                told.append(cause)
                text = f"{case.label}: {_say(given)}; expected: {_say(_Model().answer(case))}"
                yield wrong(text, cause or otherwise or shared.cause(case.otherwise))


def _explained(seen: Sequence[dict[str, Any] | Failure]) -> tuple[Mistake, ...]:
    """Find the fewest mistakes that lead to exactly what was returned; none when nothing that is known does."""
    for count in range(3):
        for chosen in combinations(MISTAKES, count):
            parts = {each.part: each.value for each in chosen}
            if len(parts) == count:
                model = replace(_Model(), **parts)
                answers = [(case, given) for case, given in zip(CASES, seen) if not isinstance(given, Failure)]
                if all(_same(case, given, model.answer(case)) for case, given in answers):
                    return chosen
    return ()


def _by(mistake: Mistake) -> _Model:
    return replace(_Model(), **{mistake.part: mistake.value})


def _kept(seen: Sequence[dict[str, Any] | Failure]) -> str:
    """Say that a dict is kept from call to call, if that explains what is too much."""
    before: dict[str, float] = {}
    kept = False
    for case, given in zip(CASES, seen):
        if isinstance(given, Failure):
            continue
        wanted = _Model().answer(case)
        extra = {name: q for name, q in given.items() if name not in wanted and name != case.optional}
        if any(name not in given for name in wanted) or any(before.get(name) != q for name, q in extra.items()):
            return ""
        kept = kept or bool(extra)
        before.update(given)
    return KEPT if kept else ""


def _is_right(case: _Case, given: Any) -> bool:
    return _same(case, given, _Model().answer(case))


def _same(case: _Case, given: Any, wanted: Mapping[str, float]) -> bool:
    a, b = ({name: q for name, q in each.items() if name != case.optional} for each in (given, wanted))
    return a.keys() == b.keys() and all(_near(a[name], q) for name, q in b.items())


def _near(value: float, wanted: float) -> bool:
    return abs(value - wanted) < 1e-9 or value == wanted or (isnan(value) and isnan(wanted))


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) or (hasattr(value, "__float__") and not isinstance(value, (str, bytes)))


def _is_pairs(value: Any) -> bool:
    """Whether it is made of pairs, as far as that can be told without changing it."""
    if isinstance(value, (list, tuple, set, frozenset)):
        return bool(value) and all(isinstance(each, tuple) and len(each) == 2 for each in value)
    return isinstance(value, Iterator)


def _say(positions: Mapping[str, Any]) -> str:
    pairs = sorted(positions.items(), key=lambda pair: str(pair[0]))
    said = {name: f"{q:g}" if isinstance(q, float) else repr(q) for name, q in pairs}
    return "{" + ", ".join(f"{name}: {q}" for name, q in said.items()) + "}"


def _called(value: Any) -> str:
    return "None" if value is None else f"a {type(value).__name__}"
