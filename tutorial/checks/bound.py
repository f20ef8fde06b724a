"""The exercise `bound`: read four axes from any message.

Write the function `four_axes(message)`. It returns the first four axes of a `Joy` message, as a list or an array of
four numbers from -1 to 1, whatever the message contains:

- An axis outside the range from -1 to 1 is clamped: 1.5 counts as 1, and -3 as -1.
- An axis that is missing or not finite (NaN or an infinity) counts as 0.
- A bad axis does not affect other axes.

The control loop calls the function a thousand times a second, so it must not take longer for a million axes than for
four. It never raises an exception, and it leaves the message unchanged.

Hint 1: Which axes do you have to read, however many there are? And what can be wrong with a single axis? It can be
missing, not finite, too large or too small.

Hint 2: The slice axes[:4] has four axes, or fewer if the message has fewer. Append zeros to it, and use the first four
numbers of the result. Then go through these four numbers. Check isfinite first, because NaN is neither smaller nor
larger than any number, and clamp the finite numbers with max and min.

Hint 3: axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4], and then a list of min(max(axis, -1.0), 1.0) if
isfinite(axis) else 0.0, for axis in axes.

Notice that no message can make the function fail or slow it down: it reads at most four axes and checks each of them
before using it.
"""

import tracemalloc
from array import array
from collections.abc import Iterator
from math import inf, isfinite, nan
from typing import Any

from sensor_msgs.msg import Joy

from tutorial.checks.engine.cases import Case, Cases, Mistake, Run, replace
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.interleave import traced
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise


def four_axes(message: Joy) -> list[float]:
    """Return the sticks' axes, clamped to [-1, 1]; a missing or non-finite axis counts as 0."""
    axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4]
    return [min(max(axis, -1.0), 1.0) if isfinite(axis) else 0.0 for axis in axes]


MISTAKES = [
    Mistake("your code removes an invalid axis, so the axes after it end up in the wrong places. Use 0 if an "
            "axis isn't finite, and the nearest limit if it is outside the range.",
            replace("*message.axes[:4],", "*filter(isfinite, message.axes[:4]),",
                    "*filter(lambda axis: -1.0 <= axis <= 1.0, message.axes[:4]),")),
    Mistake("your code never returns a negative number. The range is -1 to 1: min(max(axis, -1.0), 1.0).",
            replace("max(axis, -1.0)", "max(axis, 0.0)", "abs(axis)")),
]  # fmt: skip
MEANING = ("Compare your steps with these: use the first four axes, in their order; "
           "use 0 for each axis that is missing or not finite, and clamp the other axes.")  # fmt: skip
ALL = ("Your code probably copies all axes, or goes through all of them. "
       "Start with message.axes[:4], which copies only four axes.")  # fmt: skip
A_LIST = "Return a list of four numbers: return [... for axis in axes], with square brackets."

LONG = "it takes far longer than for four axes"

STEPS = 1000  # the maximum number of executed lines plus axes read; four axes need fewer than 100
FOUR = (0.5, -0.625, 0.75, -1.0)
MILLION = 1_000_000
BYTES = MILLION // 2  # memory limit for an answer: less than one byte per axis


def given(*axes: float) -> Run:
    """Observe the result for a message with these axes."""
    return lambda trial: trial.ask(Joy(axes=axes), read=numbers, wanted=A_LIST)


def numbers(returned: Any) -> list[float]:
    """Convert an answer's result to floats."""
    return [float(each + 0.0) for each in returned]


def twice(trial: Trial) -> list[float]:
    """Observe the results of two calls, both read after the second call."""
    both = [trial.call(trial.answer, Joy(axes=axes)) for axes in (FOUR, FOUR[::-1])]
    return [number for returned in both for number in numbers(returned)]


class Million(array):  # type: ignore[type-arg]
    """Axes that count how many times they are read, and how many lines run in the meantime."""

    steps = 0

    def step(self, *_: object) -> Any:
        """Count one step. The method also serves as a trace function."""
        self.steps += 1
        if self.steps > STEPS:
            raise Misuse(LONG, ALL)
        return self.step

    def __iter__(self) -> Iterator[float]:
        return filter(lambda _: self.step(), super().__iter__())


def million(trial: Trial) -> list[float]:
    """Observe the result for a million axes.

    Raises:
        Misuse: the answer reads or copies more than a few axes.
    """
    axes, message = Million("f", array("f", FOUR) * (MILLION // len(FOUR))), Joy()
    message._axes = axes  # the property would convert them to a plain array
    tracemalloc.start()
    try:
        with traced(trial, axes.step):
            returned = trial.call(trial.answer, message)
        if axes.steps > STEPS or tracemalloc.get_traced_memory()[1] > BYTES:
            raise Misuse(LONG, ALL)
    finally:
        tracemalloc.stop()
    return numbers(returned)


SHORT = ("Your code probably expects four axes, or drops messages with fewer. "
         "Use the axes that the message has; missing axes count as 0.")  # fmt: skip
INFINITE = ("Your code probably clamps an infinity to 1 or -1. Use 0 instead: check isfinite(axis) "
            "first. (isnan detects only NaN.)")  # fmt: skip
BEYOND = ("Your code probably doesn't change an axis outside the range from -1 to 1, sets it to 0, "
          "or scales all axes. Clamp it: min(max(axis, -1.0), 1.0).")  # fmt: skip
CASES = [
    Case("four axes", given(*FOUR)),
    Case("six axes", given(0.5, -0.625, 0.75, 0.4375, 1.0, 0.875),
         "Your code probably requires a fixed number of axes. A message can have more than four; use only the first "
         "four: message.axes[:4].", crashes=True),
    Case("three axes", given(0.75, 0.5, -0.625), SHORT, crashes=True),
    Case("one axis", given(0.75), SHORT, crashes=True),
    Case("no axes", given(), SHORT, crashes=True),
    Case("NaN for the second axis", given(0.5, nan, 0.75, -0.625),
         "Your code probably removes NaN, lets it change the other axes, or clamps it. Use 0 instead: "
         "check isfinite(axis) first.", crashes=True),
    Case("infinity for the first axis", given(inf, -0.625, 0.75, 0.5), INFINITE, crashes=True),
    Case("minus infinity for the last axis", given(0.625, 0.5, -0.75, -inf), INFINITE, crashes=True),
    Case("1.5 for the first axis", given(1.5, 0.625, -0.75, 0.5), BEYOND, crashes=True),
    Case("-3 for the third axis", given(0.625, 0.5, -3.0, -0.75), BEYOND, crashes=True),
    Case("1e30 for the last axis", given(0.5, 0.625, -0.75, 1e30), BEYOND, crashes=True),
    Case("minus infinity, 2 and NaN in one message", given(-inf, 2.0, nan, -0.5), INFINITE, crashes=True),
    Case("sticks almost centred", given(0.0390625, -0.03515625, 0.02734375, 0.0)),
    Case("only one axis, which is NaN", given(nan), SHORT, crashes=True),
    Case("NaN and infinity after the fourth axis", given(*FOUR, nan, inf), INFINITE, crashes=True),
    Case("two messages, both results read at the end", twice,
         "Your code probably returns the same list from every call, and changes it. Make a new list in each call.",
         crashes=True),
    Case("a million axes", million),
]  # fmt: skip

bound = Exercise("bound", __doc__, Cases(four_axes, CASES, MISTAKES, MEANING), imports=("from math import isfinite",))
