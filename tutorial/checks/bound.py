"""The exercise `bound`: read four axes from any message.

Write the function `four_axes(message)`. It returns the first four axes of the `Joy` `message` as a list or an
array of four numbers from -1 to 1, whatever the message holds:

- An axis beyond -1 or 1 is limited to that end.
- An axis that is not finite, NaN or an infinity, counts as 0, and so does a missing axis.
- Each axis stands for itself: if one is wrong, the others still count.

The control loop calls it a thousand times a second, so a million axes take no longer than four. It never raises, and
leaves the message as it is.

Hint 1: Look at how much of the message you touch, however many axes there are. And look at what may be wrong with a
single axis: missing, not finite, too large, too small.

Hint 2: A slice takes at most four, and fewer if there are fewer: put zeros behind it, and take four of all. Then go
through those four: ask isfinite first, because NaN is neither smaller nor larger than a number, and limit the others
with max and min.

Hint 3: axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4], and then a list of min(max(axis, -1.0), 1.0) if
isfinite(axis) else 0.0, for axis in axes.

Notice that no message can make it fail or take long, because it limits every value before anything uses it.
"""

import tracemalloc
from array import array
from collections.abc import Iterator
from math import inf, isfinite, nan
from typing import Any

from sensor_msgs.msg import Joy

from tutorial.checks.exercise import Case, Cases, Exercise, Misuse, ask, call, traced


def four_axes(message: Joy) -> list[float]:
    """Return the sticks' axes, each in [-1, 1]; one that the message lacks, or that is not finite, counts as 0."""
    axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4]
    return [min(max(axis, -1.0), 1.0) if isfinite(axis) else 0.0 for axis in axes]


MISTAKES = """
#
Compare with: all of the first four axes, in order, each by itself, 0 if lacking or not finite, limited to -1 and 1.

# six axes
Most likely a certain number of axes is expected: there may be more, and the first four count, message.axes[:4].

# three axes
# one axis
# no axes
Most likely a short message is dropped, or four axes are taken for granted: what it lacks counts as 0, the rest stays.

# NaN for
Most likely it is left out, spoils the others, or min and max let it through: it counts as 0, and isfinite(axis) tells.

# infinity
An infinity counts as 0, and not as 1 or -1: ask isfinite(axis) before anything else; isnan does not tell.

# 1.5 for
# -3 for
# 1e30 for
Most likely an axis beyond -1 or 1 counts as it is, as 0, or all are scaled: limit one alone, min(max(axis, -1.0), 1.0).

# two messages
Most likely the list is kept from call to call: make a new one in every call.
"""
ALL = "Most likely all of the axes are copied or gone through: begin with message.axes[:4], the first four."
A_LIST = "Return a list of four numbers: return [... for axis in axes], with square brackets."

LONG = "it takes far longer than for four"

STEPS = 1000  # lines that run and axes that are read, of which four axes take less than 100
FOUR = (0.5, -0.625, 0.75, -1.0)
MILLION = 1_000_000
BYTES = MILLION // 2  # that may be taken at once: less than one for each axis


def given(*axes: float) -> Case:
    """Observe what is returned for a message with these axes."""
    return lambda answer: ask(answer, Joy(axes=axes), read=numbers, wanted=A_LIST)


def numbers(returned: Any) -> list[float]:
    """Return the numbers that an answer has returned."""
    return [float(each + 0.0) for each in returned]


def twice(answer: Any) -> list[float]:
    """Observe the numbers of the two lists that are returned for two messages, once both are there."""
    both = [call(answer, Joy(axes=axes)) for axes in (FOUR, FOUR[::-1])]
    return [number for returned in both for number in returned]


class Million(array):  # type: ignore[type-arg]
    """Axes which count how many of them are gone through, and how many lines run meanwhile."""

    steps = 0

    def step(self, *_: object) -> Any:
        """Count; a trace function, too."""
        self.steps += 1
        if self.steps > STEPS:
            raise Misuse(LONG, ALL)
        return self.step

    def __iter__(self) -> Iterator[float]:
        return filter(lambda _: self.step(), super().__iter__())


def million(answer: Any) -> list[float]:
    """Observe what is returned for a million axes; more than a few of them are neither looked at nor copied."""
    axes, message = Million("f", array("f", FOUR) * (MILLION // len(FOUR))), Joy()
    message._axes = axes  # as they are: the property would make a plain array of them
    tracemalloc.start()
    try:
        with traced(axes.step):
            returned = call(answer, message)
        if axes.steps > STEPS or tracemalloc.get_traced_memory()[1] > BYTES:
            raise Misuse(LONG, ALL)
    finally:
        tracemalloc.stop()
    return numbers(returned)


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

CASES = Cases(four_axes, TRIED, MISTAKES, str, crashes=[""])
bound = Exercise("bound", __doc__, CASES, imports=("from math import isfinite",))
