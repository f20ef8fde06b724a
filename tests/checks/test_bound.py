"""The exercise `bound`: every wrong answer is told its cause."""

from __future__ import annotations

import math
import time
from itertools import islice, zip_longest
from math import isfinite, isinf, isnan

import numpy as np
import pytest

from tutorial.checks.tank_controller import bound, four_axes

_kept = [0.0] * 4


def limited(axis):
    return min(max(axis, -1.0), 1.0)


def safe(axis):
    return limited(axis) if isfinite(axis) else 0.0


def padded(message):
    return [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4]


# --- right answers


def by_index(message):
    found = []
    for i in range(4):
        axis = message.axes[i] if i < len(message.axes) else 0.0
        found.append(0.0 if isnan(axis) or isinf(axis) else max(-1.0, min(1.0, axis)))
    return found


def by_iterator(message):
    return tuple(safe(axis or 0.0) for axis, _ in zip_longest(islice(message.axes, 4), range(4), fillvalue=0.0))


def by_comparing(message):
    found = [0.0, 0.0, 0.0, 0.0]
    for i, axis in enumerate(message.axes[:4]):
        if -math.inf < axis < math.inf:  # false of NaN, too
            found[i] = 1 if axis > 1 else -1 if axis < -1 else axis
    return found


def by_numpy(message):
    axes = np.zeros(4)
    given = np.asarray(message.axes[:4])
    axes[: len(given)] = given
    return np.clip(np.nan_to_num(axes, posinf=0.0, neginf=0.0), -1.0, 1.0)


def with_more_zeros(message):
    axes = message.axes[:4].tolist()
    while len(axes) < 4:
        axes.append(0)
    return list(map(safe, axes))


@pytest.mark.parametrize("answer", [four_axes, by_index, by_iterator, by_comparing, by_numpy, with_more_zeros])
def test_right_answers_are_right(answer):
    verdict = bound.judge(answer)
    assert verdict.right, str(verdict)


# --- wrong answers


def unpacks(message):
    a, b, c, d = message.axes
    return [safe(a), safe(b), safe(c), safe(d)]


def indexes(message):
    return [safe(message.axes[i]) for i in range(4)]


def takes_all(message):
    return [safe(axis) for axis in [*message.axes, 0.0, 0.0, 0.0, 0.0][:4]]


def goes_through_all(message):
    return [safe(axis) for axis in message.axes][:4] + [0.0] * (4 - len(message.axes))


def counts_through_all(message):
    axes = [0.0, 0.0, 0.0, 0.0]
    for i in range(len(message.axes)):
        if i < 4:
            axes[i] = safe(message.axes[i])
    return axes


def copies_all_at_once(message):
    return four_axes(type(message)(axes=message.axes.tolist()))


def copies_all_by_numpy(message):
    return by_numpy(type(message)(axes=np.nan_to_num(message.axes, nan=math.nan, posinf=math.inf, neginf=-math.inf)))


def returns_all(message):
    return [safe(axis) for axis in message.axes]


def returns_fewer(message):
    return [safe(axis) for axis in message.axes[:4]]


def rests_with_fewer(message):
    return [safe(axis) for axis in message.axes[:4]] if len(message.axes) >= 4 else [0.0] * 4


def rests_unless_four(message):
    return [safe(axis) for axis in message.axes] if len(message.axes) == 4 else [0.0] * 4


def zeros_in_front(message):
    return [0.0] * (4 - len(message.axes)) + [safe(axis) for axis in message.axes[:4]]


def passes_on(message):
    return padded(message)


def forgets_nan(message):
    return [limited(axis) for axis in padded(message)]


def nan_to_one(message):
    return [max(-1.0, min(1.0, axis)) for axis in padded(message)]


def nan_to_minus_one(message):
    return [min(1.0, max(-1.0, axis)) for axis in padded(message)]


def only_nan(message):
    return [0.0 if isnan(axis) else limited(axis) for axis in padded(message)]


def only_infinity(message):
    return [0.0 if isinf(axis) else limited(axis) for axis in padded(message)]


def compares_with_nan(message):
    return [0.0 if axis in (math.nan, math.inf, -math.inf) else limited(axis) for axis in padded(message)]


def leaves_out(message):
    return padded(type(message)(axes=[limited(axis) for axis in message.axes[:4] if isfinite(axis)]))


def all_or_nothing(message):
    axes = padded(message)
    return [limited(axis) for axis in axes] if all(map(isfinite, axes)) else [0.0] * 4


def not_limited(message):
    return [axis if isfinite(axis) else 0.0 for axis in padded(message)]


def only_the_upper_end(message):
    return [min(axis, 1.0) if isfinite(axis) else 0.0 for axis in padded(message)]


def only_the_lower_end(message):
    return [max(axis, -1.0) if isfinite(axis) else 0.0 for axis in padded(message)]


def drops_what_is_beyond(message):
    return [axis if abs(axis) <= 1.0 else 0.0 for axis in padded(message)]


def scales(message):
    axes = [axis if isfinite(axis) else 0.0 for axis in padded(message)]
    return [axis / max(1.0, *map(abs, axes)) for axis in axes]


def exchanges_min_and_max(message):
    return [max(min(axis, -1.0), 1.0) if isfinite(axis) else 0.0 for axis in padded(message)]


def only_min(message):
    return [min(axis, -1.0, 1.0) if isfinite(axis) else 0.0 for axis in padded(message)]


def only_zeros(message):
    return [0.0 for axis in padded(message)]


def dead(message):
    return [axis if abs(axis) > 0.2 else 0.0 for axis in four_axes(message)]


def absolute(message):
    return [abs(axis) for axis in four_axes(message)]


def whole(message):
    return [int(axis) for axis in four_axes(message)]


def rounds_nan(message):
    return [limited(round(axis, 6) if round(axis) else axis) for axis in padded(message)]


def right_stick_first(message):
    axes = four_axes(message)
    return axes[2:] + axes[:2]


def no_return(message):
    four_axes(message)


def lazy(message):
    return (safe(axis) for axis in padded(message))


def named(message):
    return dict(zip("abcd", four_axes(message)))


def texts(message):
    return [f"{axis:.2f} m" for axis in four_axes(message)]


def appends(message):
    while len(message.axes) < 4:
        message.axes.append(0.0)
    return [safe(axis) for axis in message.axes[:4]]


def overwrites(message):
    message.axes = four_axes(message)
    return list(message.axes)


def keeps(message):
    _kept[:] = four_axes(message)
    return _kept


def sleeps(message):
    time.sleep(0.001)
    return four_axes(message)


CAUSES = [
    (unpacks, "a certain number of axes is expected"),
    (indexes, "four axes are taken for granted"),
    (takes_all, "all of the axes are copied or gone through"),
    (goes_through_all, "all of the axes are copied or gone through"),
    (counts_through_all, "all of the axes are copied or gone through"),
    (copies_all_at_once, "all of the axes are copied or gone through"),
    (copies_all_by_numpy, "all of the axes are copied or gone through"),
    (returns_all, "all axes are returned"),
    (returns_fewer, "fewer than four are returned"),
    (rests_with_fewer, "a message with fewer axes counts as rest"),
    (rests_unless_four, "a message with more than four axes counts as rest"),
    (zeros_in_front, "the zeros go in front"),
    (passes_on, "NaN and infinities are passed on"),
    (forgets_nan, "min and max let it through"),
    (nan_to_one, "min and max make 1 of NaN"),
    (nan_to_minus_one, "min and max make -1 of NaN"),
    (only_nan, "an infinity is limited to 1 or -1"),
    (only_infinity, "isinf does not tell it"),
    (compares_with_nan, "isinf does not tell it"),
    (leaves_out, "the axes behind them move up"),
    (all_or_nothing, "one NaN or infinity makes all four 0"),
    (not_limited, "an axis beyond 1 or -1 is passed on"),
    (only_the_upper_end, "only the upper end is limited"),
    (only_the_lower_end, "only the lower end is limited"),
    (drops_what_is_beyond, "an axis beyond 1 or -1 counts as 0"),
    (scales, "all axes are scaled down"),
    (exchanges_min_and_max, "min and max are not where they belong"),
    (only_min, "min and max are not where they belong"),
    (only_zeros, "the axes are not read at all"),
    (dead, "there is a dead zone"),
    (absolute, "the sign is lost"),
    (whole, "rounded to whole numbers"),
    (rounds_nan, "something is done with NaN"),
    (right_stick_first, "the two sticks are exchanged"),
    (no_return, "return is missing"),
    (lazy, "square ones make a list"),
    (named, "Return a list of four numbers"),
    (texts, "Return a list of four numbers"),
    (appends, "changes the message itself"),
    (overwrites, "changes the message itself"),
    (keeps, "_kept is kept from call to call"),
    (sleeps, "sleeps"),
]


@pytest.mark.parametrize(("answer", "cause"), CAUSES, ids=lambda value: getattr(value, "__name__", ""))
def test_each_wrong_answer_is_told_its_cause(answer, cause):
    verdict = bound.judge(answer)
    assert not verdict.right
    assert cause in str(verdict)
