"""Two threads in every order."""

from itertools import count, takewhile

import pytest
from sensor_msgs.msg import Joy

from tutorial.checks.engine.failure import Failure
from tutorial.checks.engine.interleave import early, interleave
from tutorial.checks.engine.trial import Trial


def add_twice(kept):
    before = kept[0]
    kept[0] = before + 1


def test_a_lost_update_is_found():
    sums = []

    def turn(at):
        kept = [0]
        more = interleave(Trial(add_twice), lambda: add_twice(kept), lambda: kept.__setitem__(0, kept[0] + 1), at)
        sums.append(kept[0])
        return more

    assert len([*takewhile(turn, count())]) > 4
    assert {*sums} == {1, 2}


def test_a_slow_turn_ends_before_the_function_continues():
    ended, seen = [], []
    numbers = range(1_000_000)

    def look():
        seen.append(len(ended))

    def turn():
        for _ in range(10):
            sum(numbers)  # keeps the interpreter busy, as a garbage collection does
        ended.append(True)

    assert interleave(Trial(look), look, turn, 0)
    assert seen == [1]


class Subscribes:
    def __init__(self, trial, node):
        node.create_subscription(Joy, "joy", self.on_joy, 1)
        self.joy = None

    def on_joy(self, message):
        self.joy.append(message)


def test_early():
    with pytest.raises(Failure, match="Misuse") as info:
        early(Subscribes, Joy())(Trial(Subscribes))
    assert "the first message arrives while configure runs" in str(info.value.error)
