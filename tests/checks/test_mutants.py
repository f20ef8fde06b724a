"""Small faults in the right answers, of which ``make mutants`` judges all: here a fixed sample."""

from __future__ import annotations

import asyncio
import itertools

import forks
import pytest
from equivalent_mutants import EQUIVALENT
from mutation import define, mutants, mutants_of, rejects
from programs import PATIENCE

from tutorial.checks import _contain
from tutorial.checks.catalogue import exercises

EXERCISES = {each.name: each for those in exercises().values() for each in those}
SAMPLE = 5  # mutants of each exercise
JOBS = 2


def listed(name):
    return {change for changes in EQUIVALENT.get(name, {}).values() for change in changes}


def sample(exercise):
    """Some that are wrong, from all over the answer: the same ones every time."""
    wrong = [mutant for mutant in mutants_of(exercise) if mutant.change not in listed(exercise.name)]
    return [wrong[(2 * i + 1) * len(wrong) // (2 * SAMPLE)] for i in range(SAMPLE)]


@pytest.mark.process
@pytest.mark.parametrize("name", EXERCISES)
def test_mutants_are_rejected(name, monkeypatch):
    monkeypatch.setattr(_contain, "_start", forks.start)
    exercise = EXERCISES[name]
    chosen = sample(exercise)

    async def judged():
        turn = asyncio.Semaphore(JOBS)

        async def judge(mutant):
            async with turn:
                return await rejects(exercise, mutant, PATIENCE)

        return await asyncio.gather(*map(judge, chosen))

    assert [mutant.change for mutant, rejected in zip(chosen, asyncio.run(judged())) if not rejected] == []


@pytest.mark.process
@pytest.mark.parametrize("name", EXERCISES)
def test_mutants_are_told_apart_by_their_change_and_can_be_defined(name):
    made = mutants_of(EXERCISES[name])
    assert len({mutant.change for mutant in made}) == len({mutant.source for mutant in made}) == len(made)
    for mutant in made:
        assert define(EXERCISES[name], mutant).__module__ == "__main__"


def test_every_equivalent_one_is_a_mutant_still():
    for name in EQUIVALENT:
        assert listed(name) <= {mutant.change for mutant in mutants_of(EXERCISES[name])}
        assert all(a.isdisjoint(b) for a, b in itertools.combinations(map(set, EQUIVALENT[name].values()), 2))


def changes(source):
    return [mutant.change for mutant in mutants(source)]


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("a = b + c", "a = b + c → a = b - c"),
        ("a = b < c", "a = b < c → a = b <= c"),
        ("a = 2", "a = 2 → a = 3"),
        ("a = True", "a = True → a = False"),
        ("a = [b for b in c if not d]", "a = [b for b in c if not d] → a = [b for b in c]"),
        ("def f():\n  a()\n  b()", "a(); b() → b(); a()"),
        ("def f():\n  a()\n  b()", "a() → nothing"),
        ("def f():\n  if a:\n    b()", "if a: → if not a:"),
        ("def f(a, b):\n  c(a, b)", "c(a, b) → c(b, b)"),
        ("def f(a):\n  c(max(a, 0))", "c(max(a, 0)) → c(min(a, 0))"),
    ],
)
def test_faults_of_every_kind_are_made(source, expected):
    assert expected in changes(source)
