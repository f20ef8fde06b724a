"""The exercise `lean`: every wrong answer is told from the others."""

from __future__ import annotations

from math import acos, atan2, degrees

import pytest

from tutorial.checks.raw_imu_publisher import lean, tilt


def in_degrees(message):
    return degrees(tilt(message))


def to_one_side(message):
    return atan2(message.linear_acceleration.x, message.linear_acceleration.z)


def on_earth(message):
    return acos(min(message.linear_acceleration.z / 9.81, 1.0))


def sideways(message):
    return acos(message.linear_acceleration.x / 9.81)


@pytest.mark.parametrize(
    ("answer", "cause"),
    [
        (in_degrees, "it is in degrees"),
        (to_one_side, "only one of x and y counts"),
        (on_earth, "gravity is typed in"),
        (sideways, "the arc cosine of z"),
    ],
)
def test_a_wrong_answer_gets_its_own_sentence(answer, cause):
    (said,) = lean.judge(answer).causes
    assert cause in said


def test_the_solution_is_right():
    assert lean.judge(tilt).right
