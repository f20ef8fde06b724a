"""Measure the exercises' checks: they should reject every mutant of a right answer, unless it is equivalent.

``make mutants`` runs it; it takes about a minute. It judges each mutant of each right answer like a learner's answer,
in its own process and ROS domain, two at a time; these processes are forks (`forks`). The exit status is 1 if more
than 2 % of an exercise's mutants survive, or if a mutant that is listed as equivalent is rejected.
"""

import asyncio
import sys
from collections.abc import Sequence

import tutorial  # noqa: F401 - makes rclpy importable

# isort: split
import click
import forks
from equivalent_mutants import EQUIVALENT, EXERCISES
from mutation import Mutant, mutants_of, rejects
from tables import console, show

from tutorial.checks.engine import contain
from tutorial.checks.exercise import Exercise

REQUIRED = 0.98  # share of an exercise's mutants that have to be rejected or equivalent
LIMIT = 60.0  # [s] time limit for a mutant; without a verdict by then, it was not rejected
JOBS = 2

Outcome = dict[Mutant, bool]  # whether each mutant is rejected


async def judge_all(asked: Sequence[Exercise]) -> dict[str, Outcome]:
    """Judge every mutant of some exercises, `JOBS` at a time; return the outcomes by exercise."""
    turn = asyncio.Semaphore(JOBS)

    async def judge_one(exercise: Exercise, mutant: Mutant) -> bool:
        async with turn:
            return await rejects(exercise, mutant, LIMIT)

    outcomes = {}
    for exercise in asked:
        mutants = mutants_of(exercise)
        console.print(f"{exercise.name}: {len(mutants)} mutants", style="dim")
        rejected = await asyncio.gather(*(judge_one(exercise, mutant) for mutant in mutants))
        outcomes[exercise.name] = dict(zip(mutants, rejected))
    return outcomes


def show_all(outcomes: dict[str, Outcome]) -> int:
    """Print the table and the survivors; return the exit status."""
    failed, rows, bad = False, list[tuple[str, ...]](), list[str]()
    for name, outcome in outcomes.items():
        listed = {change for changes in EQUIVALENT.get(name, {}).values() for change in changes}
        rejected = {mutant.change for mutant, is_rejected in outcome.items() if is_rejected}
        survived = [mutant.change for mutant in outcome if mutant.change not in rejected | listed]
        score = 1 - len(survived) / len(outcome)
        counts = (len(outcome), len(rejected), len(outcome) - len(rejected) - len(survived), len(survived))
        rows.append((name, *map(str, counts), f"{score:.1%}"))
        bad += [f"{name}: is listed as equivalent, and rejected: {change}" for change in rejected & listed]
        bad += [f"{name}: survived; no more than {1 - REQUIRED:.0%} may: {change}" for change in survived]
        failed = failed or bool(rejected & listed) or score < REQUIRED
    show(("exercise", "mutants", "rejected", "equivalent", "survived", "score"), rows)
    for line in bad:
        console.print(line, style="red", highlight=False, markup=False, soft_wrap=True)
    return int(failed)


@click.command(help=__doc__)
@click.argument("names", metavar="[EXERCISE]...", nargs=-1, type=click.Choice(list(EXERCISES)))
def main(names: tuple[str, ...]) -> None:
    """Run the given exercises' mutants, and exit with the status."""
    contain._start = forks.start  # type: ignore[assignment]
    sys.exit(show_all(asyncio.run(judge_all([EXERCISES[name] for name in names or EXERCISES]))))


if __name__ == "__main__":
    main()
