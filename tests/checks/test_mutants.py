"""A fixed sample of the small faults in solutions, all of which ``make mutants`` judges."""

import asyncio

import forks
import pytest
from equivalent_mutants import EQUIVALENT, EXERCISES
from mutation import mutants_of, rejects
from programs import TIMEOUT

from tutorial.checks.engine import contain

SAMPLE = 5  # mutants of each exercise
JOBS = 2


def listed(name):
    return {change for changes in EQUIVALENT.get(name, {}).values() for change in changes}


def sample(exercise):
    """Return a fixed sample of wrong mutants, spread over the answer."""
    wrong = [mutant for mutant in mutants_of(exercise) if mutant.change not in listed(exercise.name)]
    return [wrong[(2 * i + 1) * len(wrong) // (2 * SAMPLE)] for i in range(SAMPLE)]


@pytest.mark.process
@pytest.mark.parametrize("name", EXERCISES)
def test_mutants_are_rejected(name, monkeypatch):
    monkeypatch.setattr(contain, "_start", forks.start)
    exercise = EXERCISES[name]
    chosen = sample(exercise)

    async def judged():
        turn = asyncio.Semaphore(JOBS)

        async def judge(mutant):
            async with turn:
                return await rejects(exercise, mutant, TIMEOUT)

        return await asyncio.gather(*map(judge, chosen))

    assert [mutant.change for mutant, rejected in zip(chosen, asyncio.run(judged())) if not rejected] == []
