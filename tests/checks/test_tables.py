"""The tables of the exercises: each mistake that is known can be made, is one, and is told from all others."""

import inspect
from dataclasses import replace
from importlib import import_module
from itertools import permutations

import pytest

from tutorial.checks._mistakes import another, missing, slips
from tutorial.checks.catalogue import exercises

TABLES = {each: each.cases for those in exercises().values() for each in those}
every_table = pytest.mark.parametrize(("exercise", "cases"), TABLES.items(), ids=[each.name for each in TABLES])


@pytest.mark.parametrize(
    ("exercise", "mistake"),
    [pytest.param(each, row, id=each.name) for each, table in TABLES.items() for row in table.mistakes],
)
def test_each_mistake_is_diagnosed_as_itself(exercise, mistake, domain):
    twin = TABLES[exercise].mistaken(mistake)
    assert twin is not None, f"the solution has nothing that {mistake.edits} could change"
    verdict = exercise.judge(twin)
    assert not verdict.right, f"this is no mistake: {mistake}"
    assert verdict.causes == (f"Most likely {mistake.cause}",), str(verdict)


VIEWERS = {each: cases for each, cases in TABLES.items() if cases.one_by_one}


def test_each_requirement_of_a_viewer_refuses_something(domain):
    refusing = set()
    for exercise, cases in VIEWERS.items():
        made = [*cases.mistakes, *slips(missing, cases.solution)]
        wrong = [answer for answer, _ in import_module(f"answers.{exercise.name}").WRONG]
        for twin in [*filter(None, map(cases.mistaken, made)), *wrong]:
            *_, last = exercise.judge(twin).findings
            refusing |= {each for each in cases.cases if not last.right and last.text.startswith(f"{each}: ")}
    assert {each for cases in VIEWERS.values() for each in cases.cases} == refusing


SLIPS = {
    "`self.samples.clear()` is missing, or not reached.": "gyro",
    "`dq` is missing, or always 0: it is `dq_ref - dq`.": "aim",
    "a sign is wrong: it is `q_ref - q`.": "aim",
    "the comparison is another: it is `stamp - newest > 100000000`.": "gaps",
    "`name in joint_names` is not asked: it is `name in joint_names and isfinite(position)`.": "by_name",
    "`news` is not asked.": "thrift",
}


@pytest.mark.parametrize(("cause", "name"), SLIPS.items(), ids=SLIPS.values())
def test_what_is_missing_or_another_is_told_without_a_row(cause, name):
    cases = next(table for each, table in TABLES.items() if each.name == name)
    alone = replace(cases, table="#\nSomething else.")
    slip = next(each for kind in (missing, another) for each in slips(kind, cases.solution) if each.cause == cause)
    told = [finding.cause for finding in alone.judge(cases.mistaken(slip)) if not finding.right]
    assert told == [f"Most likely {cause}"]


def test_what_is_missing_is_told_beside_a_known_mistake():
    cases = next(table for each, table in TABLES.items() if each.name == "gyro")
    slip = next(each for each in slips(missing, cases.solution) if "linear" in each.cause)
    both = slip, next(each for each in cases.mistakes if "chassis" in each.cause)
    told = [finding.cause for finding in cases.judge(cases.mistaken(*both)) if not finding.right]
    assert told == [f"Most likely {each.cause}" for each in both]


@pytest.mark.filterwarnings("ignore::SyntaxWarning")
@every_table
def test_any_two_mistakes_compile_at_once(exercise, cases):
    source = "\n\n".join(map(inspect.getsource, (*cases.beside, cases.solution)))
    for one, two in permutations(cases.mistakes, 2):
        compile(two.made_in(one.made_in(source) or source) or source, one.cause, "exec")


@every_table
def test_what_no_known_mistakes_explain_names_a_case_of_the_table(exercise, cases):
    assert "" in cases.otherwise, "the table has no section # alone"
    parts = [*cases.otherwise, *cases.crashes, *(each.fails for each in cases.mistakes)]
    assert [part for part in parts if not any(part in label for label in cases.cases)] == []
