"""The exercise `bound`: right answers in various styles, and wrong ones."""

import math
import time
from itertools import islice, zip_longest

import numpy as np
from sensor_msgs.msg import Joy

from tutorial.checks.bound import four_axes


def by_index(message):
    found = []
    for i in range(4):
        axis = message.axes[i] if i < len(message.axes) else 0
        found.append(0 if math.isnan(axis) or math.isinf(axis) else max(-1, min(1, axis)))
    return found


def by_iterator(message):
    axes = (axis or 0.0 for axis, _ in zip_longest(islice(message.axes, 4), range(4), fillvalue=0.0))
    return tuple(sorted((-1.0, axis, 1.0))[1] if -math.inf < axis < math.inf else 0.0 for axis in axes)


def by_numpy(message):
    given, axes = np.asarray(message.axes)[:4], np.zeros(4)
    axes[: len(given)] = given
    return np.clip(np.nan_to_num(axes, posinf=0.0, neginf=0.0), -1.0, 1.0)


def unpacks(message):
    a, b, c, d = message.axes
    return four_axes(Joy(axes=[a, b, c, d]))


def indexes_and_reverses(message):
    return [four_axes(message)[i] for i in range(4) if message.axes[i] or True][::-1]


def rounds_nan(message):
    return four_axes(Joy(axes=[axis if round(axis) < 9 else 9 for axis in message.axes[:4]]))


def counts_through_all(message):
    axes = [0.0, 0.0, 0.0, 0.0]
    for i in range(len(message.axes)):
        if i < 4:
            axes[i] = message.axes[i]
    return four_axes(Joy(axes=axes))


def filters_all(message):
    return four_axes(Joy(axes=[*filter(math.isfinite, message.axes)]))


def sleeps(message):
    time.sleep(0.001)
    return four_axes(message)


RIGHT = [by_index, by_iterator, by_numpy]
WRONG = [
    (unpacks, ["requires a fixed number of axes"]),
    (indexes_and_reverses, ["in their order", "expects four axes"]),
    (rounds_nan, ["check isfinite(axis) first"]),
    (counts_through_all, ["copies all axes, or goes through all"]),
    (lambda message: four_axes(Joy(axes=message.axes.tolist())), ["copies all axes, or goes through all"]),
    (lambda message: [f"{axis}" for axis in four_axes(message)], ["Return a list of four numbers"]),
    (filters_all, ["removes an invalid axis", "copies all axes, or goes through all"]),
    (sleeps, ["Don't sleep"]),
]
