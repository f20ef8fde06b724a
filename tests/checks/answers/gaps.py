"""The exercise `gaps`: right answers in various styles, and wrong ones."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from rclpy.time import Time

from tutorial.checks.gaps import find_gaps, gaps

from . import edited

TENTH, SECOND = 100_000_000, 1_000_000_000


class Happening(NamedTuple):
    kind: np.str_
    before: np.int64
    after: np.int64


def by_numpys_numbers(messages):
    return [Happening(np.str_(what), *np.array([before, after])) for what, before, after in find_gaps(messages)]


def with_durations(messages):
    found, newest = [], None
    for _, message in messages:
        stamp = Time.from_msg(message.header.stamp)
        ahead = (stamp - newest).nanoseconds if newest is not None else 0
        if ahead > TENTH or ahead < -SECOND:
            found.append(("gap" if ahead > 0 else "restart", newest.nanoseconds, stamp.nanoseconds))
        if newest is None or ahead > 0 or ahead < -SECOND:
            newest = stamp
    return found


RIGHT = [by_numpys_numbers, with_durations]


def stamps_of(messages):
    return [Time.from_msg(message.header.stamp).nanoseconds for _, message in messages]


def neighbours(messages):
    steps = pairwise(stamps_of(messages))
    return [("gap" if b > a else "restart", a, b) for a, b in steps if b - a > TENTH or a - b > SECOND]


def neighbours_of_some(messages):
    return neighbours(messages) if messages[0] else []


newest_of_all: list[int] = []


def kept_newest(messages):
    stamps = stamps_of(messages)
    earlier, newest_of_all[:] = newest_of_all[:], stamps[-1:]
    return [("gap", *earlier, *stamps[:1])] if earlier else find_gaps(messages)


LAST = "your code compares each stamp with the previous one"
EMPTY = "Your code probably expects at least one message"


WRONG = [
    (edited(gaps, ('"gap"', '"GAP"')), 'The only kinds of events are "gap" and "restart".'),
    (neighbours_of_some, [LAST, EMPTY]),
    (kept_newest, ["Your code keeps newest_of_all from one call to the next"]),
]
