"""Slips, which need no table."""

import pytest

from tutorial.checks.engine.slips import another, missing, slips

SLIPS = {
    "`y = x` is missing or never reached.": (missing, "y = x", "pass"),
    "`b` is missing, or always 0. Write `a - b`.": (another, "a - b", "a - (0)"),
    "a sign is wrong. Write `a - b`.": (another, "a - b", "(-a) - b"),
    "your code uses the wrong comparison. Write `a > b`.": (another, "a > b", "(a >= b)"),
    "your code doesn't test `a`. Write `a and b`.": (another, "a and b", "(True) and b"),
    "your code doesn't test `a`.": (another, "if a: pass", "if (True): pass"),
    "your condition is reversed. Write `a`.": (another, "[0 for a in b if a]", "[0 for a in b if (not a)]"),
    "a number is wrong or missing. Write `a + 3`.": (another, "a + 3", "a + (3 * 10)"),
}


@pytest.mark.parametrize("cause", SLIPS)
def test_slips(cause):
    kind, before, after = SLIPS[cause]
    assert after in [fault.made_in(before) for fault in slips(kind, before) if fault.cause == cause]


def test_no_docstring_is_left_out():
    assert [fault.cause[:3] for fault in slips(missing, "'Text.'\nf()")] == ["`f("]


def test_the_changed_line_is_the_right_one():
    (_, fault) = slips(missing, "if a:\n    f()\nelse:\n    f()")
    assert fault.made_in("if a:\n    f()\nelse:\n    f()") is not None
