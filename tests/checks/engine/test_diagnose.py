"""Diagnoses of wrong answers to a toy exercise."""

import time

import pytest

from tutorial.checks.engine.instruments import Instruments

from . import toys


def fails(x):
    return 2 * x + 1 if x > 2 else {}["x"]


DIAGNOSES = {
    "right": (lambda x: x + x + 1, {}),
    "a mistake": (lambda x: x + 3, {"three": "your code adds 2."}),
    "two mistakes": (lambda x: 3 * (x + 2), {"two": "your code multiplies.", "three": "your code adds 2."}),
    "a slip": (lambda x: 2 * x, {"two": "`1` is missing, or always 0. Write `y + 1`."}),
    "a slip within": (lambda x: 20 * x + 1, {"two": "a number is wrong or missing. Write `2 * x`."}),
    "a meaning": (lambda x: 2 * abs(x) + 1, {"below 0": "MEANING"}),
    "unknown": (lambda x: x**3, {"two": "MEANING"}),
    "an exception": (fails, {"two": "EXCEPTION", "below 0": "EXCEPTION"}),
}


@pytest.mark.parametrize(("answer", "causes"), DIAGNOSES.values(), ids=DIAGNOSES)
def test_causes(answer, causes):
    assert toys.causes_of(answer) == causes


def test_the_clock():
    with Instruments() as instruments:
        assert toys.causes_of(lambda x: time.time(), instruments.begin) == {"two": "CLOCK"}
