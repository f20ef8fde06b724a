"""A toy exercise: a solution of three lines, its cases, and its known mistakes."""

from tutorial.checks.engine.cases import Case, Cases, Mistake, replace
from tutorial.checks.engine.diagnose import diagnose
from tutorial.checks.engine.observe import observe
from tutorial.checks.engine.report import report
from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.twins import Twins


def scaled(x):
    """Double a number, and add one."""
    y = 2 * x
    return y + 1


def given(x):
    return lambda trial: trial.call(trial.answer, x)


MISTAKES = [
    Mistake("your code adds 2.", replace("2 * x", "2 + x")),
    Mistake("your code multiplies.", replace("y + 1", "y * 3")),
]
CASES = [
    Case("two", given(2)),
    Case("three", given(3)),
    Case("below 0", given(-3), "Your code probably drops the sign."),
]
TOY = Cases(scaled, CASES, MISTAKES, "Compare with 2 * x + 1.")
TWINS = Twins(TOY)


def seen_of(answer, begin=Trial):
    return observe(TOY, answer, begin, TWINS.expected)


def causes_of(answer, begin=Trial):
    """Return the diagnosis by case: a mistake's cause, or the name of a `Why`."""
    causes = diagnose(seen_of(answer, begin), TWINS).causes
    return {label: getattr(why, "cause", None) or why.name for label, why in causes.items()}


def said_of(answer):
    seen = seen_of(answer)
    return [*report(TOY, answer, seen, diagnose(seen, TWINS))]
