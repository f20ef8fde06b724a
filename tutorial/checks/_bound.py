"""Looking at an answer to `bound`: messages as a joystick sends them, and as anybody may."""

from __future__ import annotations

import tracemalloc
from array import array
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from math import inf, isfinite, isnan, nan
from types import FrameType
from typing import Any

from sensor_msgs.msg import Joy

from tutorial.checks._answer import name_of
from tutorial.checks._diagnose import Misuse
from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._interleave import traced
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure, watch

__all__ = ["judge_bound"]

SHOWN = 9  # numbers of an answer that are looked at
FOUR = (0.25, -0.5, 0.75, -1.0)
MILLION = 1_000_000
STEPS = 1000  # lines that run and axes that are read, of which four axes take some 20
BYTES = MILLION // 2  # that may be taken at once: less than one for each axis

ENDS = ("up", "down", "there", "back")
"""Where min and max take every axis when they are not the right ones: beyond one end, or exactly there."""
MISPLACED = (
    "min and max are not where they belong: max(axis, -1.0) lifts what is below -1, min(axis, 1.0) lowers what is "
    "above 1."
)

MANY = "Most likely a certain number of axes is expected: there may be more, and the first four count."
FEW = "Most likely four axes are taken for granted: of those that the message lacks, each counts as 0."
NOT_FINITE = (
    "Most likely something is done with NaN or an infinity that only numbers take: ask isfinite(axis) before anything "
    "else."
)
BEYOND = "Most likely an axis beyond -1 or 1 is not expected: limit it to that end with min and max."
COMPARE = "Compare with: each axis by itself, 0 if it is lacking or not finite, else limited to -1 and 1."
NO_RETURN = "Most likely return is missing: give the list back."
NOT_A_LIST = "Return a list of four numbers."
LAZY = "Most likely round brackets stand around `... for ... in ...`: square ones make a list."
CHANGED = "Most likely append, an assignment or the like changes the message itself: leave it as it is, take a copy."
KEPT = "Most likely the list is kept from call to call: make a new one in every call."
SLOW = (
    "Most likely all of the axes are copied or gone through, a thousand times a second: take the first four before "
    "anything else, message.axes[:4]."
)


@dataclass(frozen=True)
class _Case:
    """One message.

    Attributes:
        label: what it is like.
        axes: what it says.
        crash: the most likely cause when something is raised.
    """

    label: str
    axes: Sequence[float]
    crash: str


CASES = (
    _Case("four axes", FOUR, FEW),
    _Case("six axes", (0.25, -0.5, 0.75, 0.125, 1.0, 0.875), MANY),
    _Case("three axes", (0.75, 0.5, -0.25), FEW),
    _Case("one axis", (0.75,), FEW),
    _Case("no axes", (), FEW),
    _Case("NaN for the second axis", (0.25, nan, 0.75, -0.5), NOT_FINITE),
    _Case("infinity for the first axis", (inf, -0.5, 0.75, 0.25), NOT_FINITE),
    _Case("minus infinity for the last axis", (0.5, 0.25, -0.75, -inf), NOT_FINITE),
    _Case("1.5 for the first axis", (1.5, 0.5, -0.75, 0.25), BEYOND),
    _Case("-3 for the third axis", (0.5, 0.25, -3.0, -0.25), BEYOND),
    _Case("1e30 for the last axis", (0.25, 0.5, -0.5, 1e30), BEYOND),
    _Case("sticks almost in the middle", (0.125, -0.0625, 0.03125, 0.0), COMPARE),
    _Case("one axis, and that is NaN", (nan,), NOT_FINITE),
    _Case("NaN and infinity behind the fourth axis", (*FOUR, nan, inf), MANY),
)

MISTAKES = (
    Mistake("many", "kept", "all axes are returned: the first four are enough, message.axes[:4]."),
    Mistake("many", "last", "the last four axes are taken: the sticks are the first four."),
    Mistake("many", "second", "the first axis is left out: it is axes[0]."),
    Mistake("many", "rest", "a message with more than four axes counts as rest: its first four count."),
    Mistake("many", "three", "only three axes are read: the slice [:4] ends before axes[4]."),
    Mistake("few", "short", "fewer than four are returned when there are fewer: fill up with zeros."),
    Mistake("few", "rest", "a message with fewer axes counts as rest: those that are there count."),
    Mistake("few", "front", "the zeros go in front, so the axes move: they go behind."),
    Mistake("few", "last", "an axis that is lacking gets the last one there is: it counts as 0."),
    Mistake("few", "one", "an axis that is lacking counts as 1: it counts as 0."),
    Mistake("odd", ("kept", "kept"), "NaN and infinities are passed on: they count as 0, isfinite(axis) tells."),
    Mistake(
        "odd",
        ("kept", "limited"),
        "NaN is passed on: min and max let it through, for it is neither smaller nor larger than a number. Ask "
        "isfinite(axis) first.",
    ),
    Mistake(
        "odd",
        ("lower", "limited"),
        "min and max make -1 of NaN, which is neither smaller nor larger than a number: ask isfinite(axis) first.",
    ),
    Mistake(
        "odd",
        ("upper", "limited"),
        "min and max make 1 of NaN, which is neither smaller nor larger than a number: ask isfinite(axis) first.",
    ),
    Mistake("odd", ("zero", "limited"), "an infinity is limited to 1 or -1: it counts as 0, as isfinite(axis) tells."),
    Mistake("odd", ("zero", "kept"), "infinities are passed on: isnan does not tell them, isfinite(axis) does."),
    Mistake(
        "odd", ("kept", "zero"), "NaN is passed on: isinf does not tell it, isfinite(axis) does (NaN == NaN is False)."
    ),
    Mistake("odd", ("rest", "rest"), "one NaN or infinity makes all four 0: each axis counts for itself."),
    Mistake(
        "odd",
        ("out", "out"),
        "NaN and infinities are left out, so the axes behind them move up: put 0 in their place.",
    ),
    Mistake("beyond", "kept", "an axis beyond 1 or -1 is passed on: limit it with min and max."),
    Mistake("beyond", "upper", "only the upper end is limited: an axis may be below -1, too."),
    Mistake("beyond", "lower", "only the lower end is limited: an axis may be above 1, too."),
    Mistake("beyond", "zero", "an axis beyond 1 or -1 counts as 0: it is limited to that end."),
    Mistake("beyond", "rest", "one axis beyond 1 or -1 makes all four 0: each axis counts for itself."),
    Mistake("beyond", "out", "axes beyond 1 or -1 are left out, so others move up: limit them in their place."),
    Mistake("beyond", "scaled", "all axes are scaled down when one is beyond 1 or -1: limit that one alone."),
    *(Mistake("beyond", end, MISPLACED) for end in ENDS),
    Mistake("value", "zero", "the axes are not read at all."),
    Mistake("value", "positive", "the lower limit is 0: a stick goes to -1."),
    Mistake("value", "dead zone", "there is a dead zone, which nobody asked for here."),
    Mistake("value", "absolute", "the sign is lost: a stick goes both ways."),
    Mistake("value", "turned", "the sign is turned round: an axis counts as it is."),
    Mistake("value", "whole", "axes are rounded to whole numbers: they count as they are."),
    Mistake("value", "reversed", "the four are in reverse order."),
    Mistake("value", "exchanged", "the two sticks are exchanged: the left one comes first."),
)


def judge_bound(answer: Callable[[Joy], Any]) -> Iterator[Finding]:
    """Look at an answer to `bound`."""
    shared = SharedState(answer)
    given: list[Any] = []
    probes: list[Probe] = []
    odd = None
    for case in CASES:
        message = Joy(axes=list(case.axes))
        try:
            returned = _call(answer, message)
        except Failure as failure:
            known = isinstance(failure.error, (LookupError, ValueError, ArithmeticError))
            odd = failure.finding(case.crash if known and not isinstance(failure.error, Misuse) else None, case.label)
            break
        odd = _judge_kind(answer, case.label, returned) or _judge_untouched(case, message)
        if odd is None and any(returned is each for each in given):
            odd = wrong(f"{case.label}: the same list is returned as the time before", shared.cause(KEPT))
        if odd is not None:
            break
        given.append(returned)
        probes.append(Probe(case.label, _numbers(returned), _say))
    all_right = yield from judged(judge_probes(probes, predict, MISTAKES, shared.cause(COMPARE)))
    if odd is not None:
        yield odd
    elif all_right:
        yield _judge_cost(answer)


def _call(answer: Callable[[Joy], Any], message: Joy) -> Any:
    with watch.call(name_of(answer)):
        return answer(message)


def _judge_kind(answer: Callable[[Joy], Any], label: str, returned: Any) -> Finding | None:
    """Look whether something else is returned than a list of numbers, or what is as good as one."""
    if returned is None:
        return wrong(f"{label}: {name_of(answer)} returns None", NO_RETURN)
    text, unlike = f"{label}: {name_of(answer)} returns a {type(returned).__name__}", (dict, set, str, bytes)
    if isinstance(returned, unlike) or not hasattr(returned, "__len__"):
        return wrong(text, LAZY if isinstance(returned, Iterator) else NOT_A_LIST)
    try:
        _numbers(returned)
    except (TypeError, ValueError):
        return wrong(f"{text} in which not everything is a number", NOT_A_LIST)
    return None


def _numbers(returned: Any) -> tuple[float, ...]:
    return tuple(float(each) for each in islice(returned, SHOWN))


def _judge_untouched(case: _Case, message: Joy) -> Finding | None:
    """Look whether the message is as it was."""
    if repr(list(message.axes)) == repr(list(Joy(axes=list(case.axes)).axes)):  # two NaNs are not equal
        return None
    return wrong(f"{case.label}: the message is not the same afterwards", CHANGED)


class _Spent(BaseException):
    """The answer has taken more steps than it may."""


class _Million(array):  # type: ignore[type-arg]
    """Axes which count how many of them are read, and how many lines of the answer run meanwhile."""

    steps = 0

    def step(self, count: int = 1) -> None:
        self.steps += count
        if self.steps > STEPS:
            raise _Spent

    def line(self, frame: FrameType, _event: str, _argument: object) -> Any:
        if frame.f_code.co_filename in watch.files:
            self.step()
            return self.line
        return None

    def __getitem__(self, index: Any) -> Any:
        found = super().__getitem__(index)
        self.step(len(found) if isinstance(found, array) else 1)
        return found

    def __iter__(self) -> Iterator[float]:
        for axis in super().__iter__():
            self.step()
            yield axis


def _judge_cost(answer: Callable[[Joy], Any]) -> Finding:
    """Look whether more than a few of a million axes are looked at, or copied."""
    axes = _Million("f", FOUR * (MILLION // len(FOUR)))
    million = Joy(axes=axes)
    returned = None
    tracemalloc.start()
    try:
        with traced(axes.line):
            returned = _call(answer, million)
    except Failure as failure:
        if axes.steps <= STEPS:
            return failure.finding(MANY, "a million axes")
    finally:
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    if axes.steps > STEPS or most > BYTES:
        return wrong("a million axes: it takes far longer than for four", SLOW)
    if _numbers(returned) != FOUR or len(million.axes) != MILLION:
        return wrong("a million axes: the first four are not returned, or the message is not the same", MANY)
    return right("a million axes: as quick as four")


def predict(
    many: str = "first",
    few: str = "zero",
    odd: tuple[str, str] = ("zero", "zero"),
    beyond: str = "limited",
    value: str = "as it is",
) -> Iterator[tuple[float, ...]]:
    """Compute what is returned for `CASES`, right or with some mistakes.

    Args:
        many, few: what becomes of a message with more, or fewer, axes than four.
        odd: what becomes of NaN, and of an infinity.
        beyond: what becomes of an axis beyond -1 or 1.
        value: what becomes of every axis in the end.
    """
    for case in CASES:
        axes = _filled(_first(list(case.axes), many), few)
        treatments = [_treatment(axis, odd, beyond) for axis in axes]
        if "rest" in treatments:
            axes, treatments = [0.0] * 4, ["kept"] * 4
        largest = max((abs(axis) for axis in axes if isfinite(axis)), default=1.0)
        if "scaled" in treatments:
            axes = [axis / largest if isfinite(axis) else axis for axis in axes]
        bounded = [_treated(axis, how) for axis, how in zip(axes, treatments) if how != "out"]
        yield tuple(_valued(_filled(bounded, few), value)[:SHOWN])


def _first(axes: list[float], many: str) -> list[float]:
    rest = [0.0] * 4 if len(axes) > 4 else axes
    return {"kept": axes, "last": axes[-4:], "second": axes[1:5], "rest": rest, "three": axes[:3]}.get(many, axes[:4])


def _treatment(axis: float, odd: tuple[str, str], beyond: str) -> str:
    if isfinite(axis):
        return beyond if abs(axis) > 1.0 or beyond in ENDS else "kept"
    return odd[0] if isnan(axis) else odd[1]


def _treated(axis: float, how: str) -> float:
    limited = 1.0 if axis > 0.0 else -1.0
    only = {"upper": min(1.0, axis), "lower": max(-1.0, axis)}  # of NaN both make their limit
    at_ends = {"up": max(axis, 1.0), "down": min(axis, -1.0), "there": 1.0, "back": -1.0}
    return {"zero": 0.0, "limited": limited, **only, **at_ends}.get(how, axis)


def _filled(axes: list[float], few: str) -> list[float]:
    missing = 4 - len(axes)
    fill = {"short": [], "last": axes[-1:] or [0.0], "one": [1.0]}.get(few, [0.0]) * missing
    if missing <= 0:
        return axes
    return [0.0] * 4 if few == "rest" else fill + axes if few == "front" else axes + fill


def _valued(axes: list[float], value: str) -> list[float]:
    if value == "exchanged":
        return [*axes[2:4], *axes[:2]]
    if value == "reversed":
        return axes[::-1]
    treat: dict[str, Callable[[float], float]] = {
        "dead zone": lambda axis: axis if abs(axis) > 0.15 else 0.0,
        "absolute": abs,
        "positive": lambda axis: max(axis, 0.0),
        "turned": lambda axis: -axis,
        "whole": lambda axis: float(int(axis)) if isfinite(axis) else axis,
        "zero": lambda _: 0.0,
    }
    return [treat[value](axis) for axis in axes] if value in treat else axes


def _say(axes: tuple[float, ...]) -> str:
    return f"[{', '.join(f'{axis + 0.0:g}' for axis in axes)}{', ...' if len(axes) == SHOWN else ''}]"
