"""Step 1's controller: for every message on ``/joy``, the sticks are four numbers from -1 to 1."""

import math
from types import SimpleNamespace

import pytest
from sensor_msgs.msg import Joy

from tutorial.controllers.tank_controller import complain, sticks
from tutorial.ros.node_thread import NodeThread


class Million(list):
    """A list that pretends to have so many axes that reading all of them would take too long."""

    __iter__ = None


@pytest.mark.parametrize(
    ("axes", "expected"),
    [
        ([0.5, -0.5, 0.25, 1.0], (0.5, -0.5, 0.25, 1.0)),
        ([0.0, 0.5], (0.0, 0.5, 0.0, 0.0)),
        ([0.1, -0.1, 0.1, 0.18], (0.0, 0.0, 0.0, pytest.approx(0.18))),
        ([2.0, -3e30, 1.0001, -1.0], (1.0, -1.0, 1.0, -1.0)),
        ([math.nan, 0.5, math.inf, -math.inf], (0.0, 0.5, 0.0, 0.0)),
    ],
)
def test_sticks_are_four_numbers_from_minus_one_to_one(axes, expected):
    assert sticks(Joy(axes=axes)) == expected


def test_surplus_axes_are_not_read():
    message = SimpleNamespace(axes=Million([0.5, -0.5, 0.25, 1.0] * 250_000))
    assert sticks(message) == (0.5, -0.5, 0.25, 1.0)
    complain(None, message)


def test_impossible_axes_are_reported_once(domain, capfd):
    with NodeThread("tester") as thread:
        for odd in (math.nan, 7.0, -math.inf):
            for _ in range(100):
                complain(thread.node, Joy(axes=[0.5, odd, 0.0, 0.0]))
        complain(thread.node, Joy(axes=[1.0, -1.0]))
    said = capfd.readouterr().err.splitlines()
    assert len(said) == 1
    assert said[0].endswith("the joystick has axes outside -1 to 1: [nan]. They are limited, or count as 0")
