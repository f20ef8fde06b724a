"""The exercise `bound`: read four axes from any message."""

from __future__ import annotations

import tracemalloc
from array import array
from collections.abc import Callable, Iterator
from itertools import islice
from math import inf, isfinite, nan
from types import FrameType
from typing import Any

from sensor_msgs.msg import Joy

from tutorial.checks._answer import name_of
from tutorial.checks._cases import Cases, call, mistakes
from tutorial.checks._diagnose import Misuse
from tutorial.checks._interleave import traced
from tutorial.checks._watch import Failure, watch
from tutorial.checks.exercise import Exercise

__all__ = ["bound", "four_axes"]


def four_axes(message: Joy) -> list[float]:
    """Return the sticks' axes, each in [-1, 1]; one that the message lacks, or that is not finite, counts as 0."""
    axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4]
    return [min(max(axis, -1.0), 1.0) if isfinite(axis) else 0.0 for axis in axes]


MISTAKES = mistakes("""
all axes are returned: the first four are enough, message.axes[:4].
    message.axes[:4] => message.axes
    0.0][:4] => 0.0][: max(4, len(message.axes))]

the last four axes are taken: the sticks are the first four.
    message.axes[:4] => message.axes[-4:]

the first axis is left out: it is axes[0].
    message.axes[:4] => message.axes[1:5]

only three axes are read: the slice [:4] ends before axes[4].
    message.axes[:4] => message.axes[:3]

a message with more than four axes counts as rest: its first four count.
    return [ => if len(message.axes) > 4: axes = [0.0] * 4 // return [

fewer than four are returned when there are fewer: fill up with zeros.
    , 0.0, 0.0, 0.0, 0.0] => ]

a message with fewer axes counts as rest: those that are there count.
    return [ => if len(message.axes) < 4: axes = [0.0] * 4 // return [

the zeros go in front, so the axes move: they go behind.
    return [ => axes = [0.0] * (4 - len(message.axes)) + axes[: len(message.axes)] // return [

an axis that is lacking gets the last one there is: it counts as 0.
    0.0, 0.0, 0.0, 0.0] => *[*message.axes[-1:], 0.0][:1] * 4]

an axis that is lacking counts as 1: it counts as 0.
    0.0, 0.0, 0.0, 0.0] => 1.0, 1.0, 1.0, 1.0]

NaN and infinities are passed on: they count as 0, isfinite(axis) tells.
    else 0.0 => else axis

infinities are passed on: isnan does not tell them, isfinite(axis) does.
    else 0.0 => else 0.0 if axis != axis else axis

NaN is passed on: min and max let it through, for it is neither smaller nor larger than a number. Ask isfinite(axis)
first.
    isfinite(axis) => True

min and max make -1 of NaN, which is neither smaller nor larger than a number: ask isfinite(axis) first.
    isfinite(axis) => True
    max(axis, -1.0) => max(-1.0, axis)

min and max make 1 of NaN, which is neither smaller nor larger than a number: ask isfinite(axis) first.
    isfinite(axis) => True
    min(max(axis, -1.0), 1.0) => max(min(1.0, axis), -1.0)

an infinity is limited to 1 or -1: it counts as 0, as isfinite(axis) tells.
    isfinite(axis) => axis == axis

NaN is passed on: isinf does not tell it, isfinite(axis) does (NaN == NaN is False).
    isfinite(axis) => axis not in (inf, -inf)

one NaN or infinity makes all four 0: each axis counts for itself.
    return [ => if not all(map(isfinite, axes)): axes = [0.0] * 4 // return [

one NaN or infinity anywhere in the message makes all four 0: each axis counts for itself, and only the first four do.
    return [ => if not all(map(isfinite, message.axes)): axes = [0.0] * 4 // return [

NaN and infinities are left out, so the axes behind them move up: put 0 in their place.
    return [ => axes = [*filter(isfinite, axes), 0.0, 0.0, 0.0, 0.0][:4] // return [

NaN and infinities are left out, so there are fewer than four: put 0 in their place.
    return [ => axes = [*filter(isfinite, axes)] // return [

an axis beyond 1 or -1 is passed on: limit it with min and max.
    min(max(axis, -1.0), 1.0) => axis

only the upper end is limited: an axis may be below -1, too.
    max(axis, -1.0) => axis

only the lower end is limited: an axis may be above 1, too.
    min(max(axis, -1.0), 1.0) => max(axis, -1.0)

an axis beyond 1 or -1 counts as 0: it is limited to that end.
    return [ => axes = [0.0 if 1.0 < abs(each) < inf else each for each in axes] // return [

an axis at 1 or -1, or beyond, counts as 0: it counts as it is there, and is limited to that end beyond.
    return [ => axes = [0.0 if 1.0 <= abs(each) < inf else each for each in axes] // return [

one axis beyond 1 or -1 makes all four 0: each axis counts for itself.
    return [ => if any(1.0 < abs(each) < inf for each in axes): axes = [0.0] * 4 // return [

axes beyond 1 or -1 are left out, so others move up: limit them in their place.
    return [ => axes = [*(each for each in axes if not 1.0 < abs(each) < inf), 0.0, 0.0, 0.0, 0.0][:4] // return [

all axes are scaled down when one is beyond 1 or -1: limit that one alone.
    return [ => axes = [each / max([1.0, *map(abs, filter(isfinite, axes))]) for each in axes] // return [

min and max are not where they belong: max(axis, -1.0) lifts what is below -1, min(axis, 1.0) lowers what is above 1.
    min(max(axis, -1.0), 1.0) => max(axis, 1.0) => min(axis, -1.0) => 1.0 => -1.0

the axes are not read at all.
    return [ => axes = [0.0] * 4 // return [

the lower limit is 0: a stick goes to -1.
    return [ => axes = [max(each, 0.0) if isfinite(each) else each for each in axes] // return [

there is a dead zone, which nobody asked for here.
    return [ => axes = [0.0 if abs(each) < 0.2 else each for each in axes] // return [

the sign is lost: a stick goes both ways.
    return [ => axes = list(map(abs, axes)) // return [

the sign is turned round: an axis counts as it is.
    return [ => axes = [-each for each in axes] // return [

axes are rounded to whole numbers: they count as they are.
    min(max(axis, -1.0), 1.0) => int(min(max(axis, -1.0), 1.0)) => round(min(max(axis, -1.0), 1.0))

only one number is returned: return stands within the loop, and belongs behind it.
    return [ => axes = axes[:1] // return [

the four are in reverse order.
    return [ => axes = axes[::-1] // return [

the two sticks are exchanged: the left one comes first.
    return [ => axes = axes[2:] + axes[:2] // return [

all of the axes are copied or gone through, a thousand times a second: take the first four before anything else,
message.axes[:4].
    message.axes[:4] => message.axes

round brackets stand around `... for ... in ...`, or it is a map or the like: square ones make a list, or list(...).
    return [ => return iter([
    for axis in axes] => for axis in axes])

return is missing: give the list back.
    return [ => [
""")
MANY = "Most likely a certain number of axes is expected: there may be more, and the first four count."
FEW = "Most likely four axes are taken for granted: of those that the message lacks, each counts as 0."
NOT_FINITE = (
    "Most likely something is done with NaN or an infinity that only numbers take: ask isfinite(axis) before anything "
    "else."
)
BEYOND = "Most likely an axis beyond -1 or 1 is not expected: limit it to that end with min and max."
CHANGED = "Most likely append, an assignment or the like changes the message itself: leave it as it is, take a copy."
KEPT = "Most likely the list is kept from call to call: make a new one in every call."
NOT_A_LIST = "Return a list of four numbers."

SHOWN = 9  # numbers of an answer that are looked at
FOUR = (0.5, -0.625, 0.75, -1.0)
MILLION = 1_000_000
STEPS = 1000  # lines that run and axes that are read, of which four axes take some 20
BYTES = MILLION // 2  # that may be taken at once: less than one for each axis
LONG = "it takes far longer than for four"


def refuse(answer: Any, what: str, cause: str) -> Failure:
    """Say what is wrong with whatever the answer has done."""
    return Failure(name_of(answer), Misuse(what, cause), None)


def numbers(answer: Any, returned: Any) -> list[float] | str:
    """Return the first of the numbers that an answer has returned, or what is there instead of them."""
    if returned is None or isinstance(returned, Iterator):
        return "nothing is returned" if returned is None else "what is returned is no list yet"
    try:
        if isinstance(returned, dict | set | str | bytes) or any(isinstance(each, str) for each in returned):
            raise TypeError
        return [float(each) for each in islice(returned, SHOWN)]
    except (TypeError, ValueError):
        raise refuse(answer, f"it returns a {type(returned).__name__}, and no list of numbers", NOT_A_LIST) from None


def given(*axes: float) -> Callable[[Any], list[float] | str]:
    """Observe what is returned for a message with these axes."""

    def observe(answer: Any) -> list[float] | str:
        message = Joy(axes=axes)
        before = str(message.axes)
        returned = call(answer, message)
        if str(message.axes) != before:
            raise refuse(answer, "the message is not the same afterwards", CHANGED)
        return numbers(answer, returned)

    return observe


def twice(answer: Any) -> list[Any]:
    """Observe the two lists that are returned for two messages, once both are there."""
    return [numbers(answer, each) for each in [call(answer, Joy(axes=axes)) for axes in (FOUR, FOUR[::-1])]]


class _Spent(BaseException):
    """The answer has taken more steps than it may."""


class Million(array):  # type: ignore[type-arg]
    """Axes which count how many of them are read, and how many lines of the answer run meanwhile."""

    steps = 0

    def step(self, count: int = 1) -> None:
        """Count."""
        self.steps += count
        if self.steps > STEPS:
            raise _Spent

    def line(self, frame: FrameType, _event: str, _argument: object) -> Any:
        """Count a line that runs."""
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


def million(answer: Any) -> list[float] | str:
    """Observe what is returned for a million axes, and whether more than a few of them are looked at, or copied."""
    axes = Million("f", array("f", FOUR) * (MILLION // len(FOUR)))
    message, returned = Joy(), None
    message._axes = axes  # as they are: the property would make a plain array of them
    tracemalloc.start()
    try:
        with traced(axes.line):
            returned = call(answer, message)
    except Failure:
        if axes.steps <= STEPS:
            raise
    finally:
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    if axes.steps > STEPS or most > BYTES:
        return LONG
    if len(message.axes) != MILLION:
        raise refuse(answer, "the message is not the same afterwards", CHANGED)
    return numbers(answer, returned)


TRIED = {
    "four axes": given(*FOUR),
    "six axes": given(0.5, -0.625, 0.75, 0.4375, 1.0, 0.875),
    "three axes": given(0.75, 0.5, -0.625),
    "one axis": given(0.75),
    "no axes": given(),
    "NaN for the second axis": given(0.5, nan, 0.75, -0.625),
    "infinity for the first axis": given(inf, -0.625, 0.75, 0.5),
    "minus infinity for the last axis": given(0.625, 0.5, -0.75, -inf),
    "1.5 for the first axis": given(1.5, 0.625, -0.75, 0.5),
    "-3 for the third axis": given(0.625, 0.5, -3.0, -0.75),
    "1e30 for the last axis": given(0.5, 0.625, -0.75, 1e30),
    "minus infinity, 2 and NaN in one message": given(-inf, 2.0, nan, -0.5),
    "sticks almost in the middle": given(0.0390625, -0.03515625, 0.02734375, 0.0),
    "one axis, and that is NaN": given(nan),
    "NaN and infinity behind the fourth axis": given(*FOUR, nan, inf),
    "two messages, one after the other": twice,
    "a million axes": million,
}
OTHERWISE = {
    "": "Compare with: the first four axes, each by itself, 0 if lacking or not finite, else limited to -1 and 1.",
    "two messages, one after the other": KEPT,
}
CRASHES = {
    "six axes": MANY,
    **dict.fromkeys(("three axes", "one axis", "no axes"), FEW),
    **dict.fromkeys(("NaN for the second axis", "infinity for the first axis"), NOT_FINITE),
    **dict.fromkeys(("1.5 for the first axis", "-3 for the third axis", "1e30 for the last axis"), BEYOND),
}


def say(seen: Any) -> str:
    """Put what was returned into words."""
    if isinstance(seen, str):
        return seen
    if seen and isinstance(seen[0], list | str):
        return " and ".join(map(say, seen))
    return f"[{', '.join(f'{axis + 0.0:g}' for axis in seen)}{', ...' * (len(seen) == SHOWN)}]"


CASES = Cases(four_axes, TRIED, MISTAKES, say, OTHERWISE, CRASHES)

bound = Exercise(
    name="bound",
    statement="""
    Write the function `four_axes(message)`. It returns the first four axes of the `Joy` `message` as a list of four
    numbers from -1 to 1, whatever anybody has put into the message:

    - An axis beyond -1 or 1 is limited to that end.
    - One that is not finite, NaN or an infinity, counts as 0, and so does one that the message lacks.
    - Each axis stands for itself: the others count as if nothing was wrong with one.

    It is called a thousand times a second, so a million axes take no longer than four. It never raises, and leaves the
    message as it is.
    """,
    judge=CASES.judge,
    solution=(four_axes,),
    base=None,
    parts=(),
    hints=(
        "Look at how much of the message is touched, however many axes there are; and at what a single axis may be: "
        "lacking, not finite, too large, too small.",
        "A slice takes at most four, and fewer where there are fewer: put zeros behind it, and take four of all. Then "
        "go through those: ask isfinite first, for NaN is neither smaller nor larger than a number, and limit the "
        "others with max and min.",
        "axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4], and then a list of min(max(axis, -1.0), 1.0) if "
        "isfinite(axis) else 0.0, for axis in axes.",
    ),
    notice="Notice that no message can make it fail or take long: whatever arrives is bounded before it is used.",
    imports=("from math import isfinite",),
)
