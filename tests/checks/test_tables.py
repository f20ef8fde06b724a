"""The tables of the exercises: each mistake that is known can be made, is one, and is told from all others."""

from __future__ import annotations

import importlib
from itertools import combinations

import pytest

from tutorial.checks.catalogue import exercises

MODULES = {each: importlib.import_module(each.module) for those in exercises().values() for each in those}
TABLES = {each: module.CASES for each, module in MODULES.items() if hasattr(module, "CASES")}
LISTS = {each: module.REQUIREMENTS for each, module in MODULES.items() if hasattr(module, "REQUIREMENTS")}
every_table = pytest.mark.parametrize(("exercise", "cases"), TABLES.items(), ids=[each.name for each in TABLES])


@every_table
def test_each_mistake_is_diagnosed_as_itself(exercise, cases):
    for mistake in cases.mistakes:
        twin = cases.mistaken(mistake)
        assert twin is not None, f"the solution has nothing that {mistake.edits} could change"
        verdict = exercise.judge(twin)
        assert not verdict.right, f"this is no mistake: {mistake}"
        assert verdict.causes == (f"Most likely {mistake.cause}",), str(verdict)


@every_table
def test_any_two_mistakes_can_be_made_at_once_unless_one_takes_away_what_the_other_changes(exercise, cases):
    made = [cases.mistaken(*two) for two in combinations(cases.mistakes, 2)]
    possible = sum(each is not None for each in made) / len(made)
    assert possible > 0.8, "too many mistakes change the same text: let an edit change less, or add a line with //"


@every_table
def test_what_no_known_mistakes_explain_names_a_case_of_the_table(exercise, cases):
    assert cases.otherwise.keys() <= cases.cases.keys() | {""}


@pytest.mark.parametrize(("exercise", "requirements"), LISTS.items(), ids=[each.name for each in LISTS])
def test_each_requirement_is_failed_by_its_mistakes_and_names_their_cause(exercise, requirements, domain):
    assert exercise.judge(requirements.solution).right
    assert requirements.mistakes.keys() <= requirements.tried.keys()
    for text, known in requirements.mistakes.items():
        for mistake in known:
            verdict = exercise.judge(requirements.mistaken(mistake))
            assert verdict.causes == (f"Most likely {mistake.cause}",), str(verdict)
            assert verdict.findings[-1].text.startswith(text)
