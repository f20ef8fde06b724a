"""What a trial records about an answer."""

import time

import pytest

from tutorial.checks.engine.failure import Failure
from tutorial.checks.engine.instruments import Instruments
from tutorial.checks.engine.trial import Trial


def raises(x):
    return x / 0


def test_a_failure_has_the_learners_line():
    with pytest.raises(Failure) as info:
        Trial(raises).call(raises, 1)
    assert (info.value.method, str(info.value.place)) == ("raises", "in raises, line 13: return x / 0")


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (lambda given: given.append(1), "it changes its argument, the list"),
        (lambda given: iter(given), "it returns a list_iterator"),
        (lambda given: None, "it returns None"),
        (lambda given: 5, "it returns a int"),
    ],
)
def test_unreadable_results(answer, said):
    with pytest.raises(Failure) as info:
        Trial(answer).ask([0], read=lambda returned: returned[0] + 1, wanted="A list.")
    assert str(info.value.error) == said


def test_no_method_may_sleep():
    def sleeps():
        time.sleep(0.0)

    with Instruments() as instruments, pytest.raises(Failure) as info:
        instruments.begin(sleeps).call(sleeps)
    assert str(info.value.error) == "it sleeps"


def test_reuse():
    kept = {}
    assert Trial(raises, kept=kept).reuse(list, "ab") is Trial(raises, kept=kept).reuse(list, "ab")
    assert Trial(raises).innermost() == {}
