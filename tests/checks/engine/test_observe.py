"""Observations, and when a check ends early."""

from dataclasses import replace
from math import nan

import pytest

from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.observe import observe, same
from tutorial.checks.engine.trial import Trial

from . import toys


def misuse(x):
    raise Misuse("text", "cause")


def labels(cases, answer):
    return [each.case.label for each in observe(cases, answer, Trial, toys.TWINS.expected).all]


def test_a_misuse_ends_it():
    assert labels(toys.TOY, misuse) == ["two"]
    assert labels(toys.TOY, lambda x: {}["x"]) == ["two", "three", "below 0"]


def test_one_by_one_stops_at_the_first_difference():
    assert labels(replace(toys.TOY, one_by_one=True), lambda x: x + 3) == ["two", "three"]


def test_shared_state():
    def counts(x, calls=[]):  # noqa: B006
        calls.append(x)
        return 2 * x + 1

    assert toys.seen_of(counts).changed == "the default value of the argument calls"


FAILURE = Failure("f", ValueError("a"))
PAIRS = [(1.0, 1.00001, True), (1.0, 1.001, False), (nan, nan, True), ((1,), [1], True), ([1], [1, 2], False)]
PAIRS += [({"a": 1}, {"a": 1.0}, True), ({"a": 1}, {"b": 1}, False), ("a", "a", True), ("1", 1, False)]
PAIRS += [
    (FAILURE, Failure("g", ValueError("b")), True),
    (FAILURE, Failure("f", KeyError()), False),
    (FAILURE, 1, False),
]


@pytest.mark.parametrize(("a", "b", "alike"), PAIRS)
def test_same(a, b, alike):
    assert same(a, b) == same(b, a) == alike
