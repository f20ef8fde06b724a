"""The sentences for a diagnosis."""

from dataclasses import replace

from tutorial.checks.engine.diagnose import Diagnosis, Why
from tutorial.checks.engine.observe import Observations
from tutorial.checks.engine.report import finding_of, report
from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.verdict import right, wrong

from . import toys


def test_a_mistake_is_named_once():
    said = toys.said_of(lambda x: x + 3)
    assert said == [right("two: 5"), wrong("three: 6; expected: 7", "Most likely your code adds 2.")]


def test_a_meaning():
    assert toys.said_of(lambda x: 2 * abs(x) + 1)[-1] == wrong(
        "below 0: 7; expected: -5", "Your code probably drops the sign."
    )


def test_shared_state_explains_more():
    seen = replace(toys.seen_of(lambda x: 0), changed="Answer.sum")
    (said, *_) = report(toys.TOY, type, seen, Diagnosis({"two": Why.MEANING}))
    assert said.cause.startswith("Answer.sum is shared by all objects")


def test_an_exception_ends_it():
    seen = Observations(toys.seen_of(lambda x: x.y).all)
    (said,) = report(toys.TOY, None, seen, Diagnosis({"two": Why.EXCEPTION, "three": Why.MEANING}))
    assert said.text == "two: <lambda> raised AttributeError: 'int' object has no attribute 'y'"


def test_a_misuse_says_why():
    failure = Trial(toys.scaled).failure("f", ValueError())
    assert finding_of(failure, toys.scaled, "Because.") == wrong("f raised ValueError", "Because.")
