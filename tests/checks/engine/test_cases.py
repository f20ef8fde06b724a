"""Edits of a source, and the meaning of a case."""

import pytest

from tutorial.checks.engine.cases import Edit, Mistake, both, replace

from . import toys

SOURCE = "def f(x):\n    if x:\n        return x"


def test_further_lines_are_indented():
    (fault,) = Mistake("", replace("return x", "x = 1\nreturn x")).faults()
    assert fault.made_in(SOURCE) == "def f(x):\n    if x:\n        x = 1\n        return x"
    assert Edit("y", "z").made_in(SOURCE) is None


def test_each_combination_of_edits_is_a_fault():
    mistake = Mistake("", both(replace("a", "b", "c"), replace("b", "d")) + replace("b", "a"))
    assert [fault.made_in("a b") for fault in mistake.faults()] == ["d d", "c d", "a a"]


def test_a_mistake_needs_an_edit():
    with pytest.raises(ValueError, match=r"'typo'. Give it one: replace\(old, new\)."):
        Mistake("typo", replace("a"))


def test_meanings():
    first, _, below = toys.CASES
    assert toys.TOY.meaning_of(first) == "Compare with 2 * x + 1."
    assert toys.TOY.meaning_of(below) == "Your code probably drops the sign."
