"""The tables of the exercises: each known mistake can be made, is wrong, and is distinguished from all others."""

from importlib import import_module
from itertools import permutations

import pytest

from tutorial.checks.catalogue import exercises
from tutorial.checks.engine.instruments import Instruments
from tutorial.checks.engine.observe import observe
from tutorial.checks.engine.slips import missing
from tutorial.checks.engine.twins import Twins

TABLES = {each: Twins(each.cases) for those in exercises().values() for each in those}
BY_NAME = {each.name: twins for each, twins in TABLES.items()}
every_table = pytest.mark.parametrize("twins", TABLES.values(), ids=BY_NAME)


@pytest.mark.parametrize(
    ("exercise", "fault"),
    [pytest.param(each, fault, id=each.name) for each, twins in TABLES.items() for fault in twins.cases.faults],
)
def test_each_mistake_is_diagnosed_as_itself(exercise, fault, domain):
    twin = TABLES[exercise].make(fault)
    assert twin is not None, f"the solution does not contain the text that {fault.edits} change"
    verdict = exercise.judge(twin)
    assert not verdict.right, f"this is no mistake: {fault}"
    assert verdict.causes == (f"Most likely {fault.cause}",), str(verdict)


VIEWERS = {each: twins for each, twins in TABLES.items() if twins.cases.one_by_one}


@pytest.mark.pocket  # on a real ROS 2 it takes minutes, and shows nothing else
def test_each_requirement_of_a_viewer_refuses_something(domain):
    refusing = set()
    for exercise, twins in VIEWERS.items():
        wrong = [answer for answer, _ in import_module(f"answers.{exercise.name}").WRONG]
        with Instruments() as instruments:
            for answer in [*map(twins.make, twins.slips(missing)), *wrong]:
                seen = observe(twins.cases, answer, instruments.begin, twins.expected)
                refusing |= {each.case.label for each in seen.odd}
    assert {case.label for twins in VIEWERS.values() for case in twins.cases.cases} == refusing


def test_a_missing_part_is_reported_beside_a_known_mistake():
    twins = BY_NAME["gyro"]
    slip = next(each for each in twins.slips(missing) if "linear" in each.cause)
    both = slip, next(each for each in twins.cases.faults if "chassis" in each.cause)
    exercise = next(each for each in TABLES if each.name == "gyro")
    assert exercise.judge(twins.make(*both)).causes == tuple(f"Most likely {each.cause}" for each in both)


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@every_table
def test_any_two_mistakes_compile_together(twins):
    for one, two in permutations(twins.cases.faults, 2):
        source = one.made_in(twins.source) or twins.source
        compile(two.made_in(source) or source, one.cause, "exec")


@every_table
def test_case_labels_are_unique(twins):
    labels = [case.label for case in twins.cases.cases]
    assert len({*labels}) == len(labels)
    assert twins.cases.meaning, "the default meaning is missing"
