"""Judges the answers in notebooks, then scores the notebooks' race drivers, and shows progress."""

# ruff: noqa: PLC0415 - only races need MuJoCo

from __future__ import annotations

import asyncio
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from tqdm import tqdm

from tutorial.commands.checking.messages import Judged, Outcome
from tutorial.commands.checking.submission import judge
from tutorial.commands.race import race_project
from tutorial.errors import TutorialError
from tutorial.program.project import Project
from tutorial.race.rules import LIMIT
from tutorial.system.printing import print_text

if TYPE_CHECKING:
    from tutorial.commands.racing import Options

Done = dict[Path, dict[str, Judged]]
"""The verdicts by notebook and exercise. The driver's verdict is under the key ``race``."""

RACE = "race"
NOT_RACED = "The driver has not raced."


async def judge_and_race(
    names: dict[Path, str], jobs: int, limit: float, is_sandboxed: bool, line: Path, done: Done
) -> None:
    """Judge notebooks, `jobs` at a time. Then race their drivers one by one, because a race needs the whole machine.

    Show a progress bar or, without a terminal, a line for each notebook and race.

    Args:
        names: the notebooks, with the names to show.
        jobs: how many notebooks to judge at the same time.
        limit: the time limit per answer [s].
        is_sandboxed: whether to use a sandbox.
        line: the YAML file of the line to race along.
        done: receives the verdicts. Even if the judging is cancelled, each notebook in `done` has all its verdicts.
    """
    drivers = await _judge_all(names, jobs, limit, is_sandboxed, done)
    if not drivers:
        return
    try:
        project = race_project(line)
    except TutorialError as error:
        for path in drivers:
            done[path][RACE] = Judged(Outcome.NOT_JUDGED, str(error), str(error))
        return
    from tutorial.commands.racing import CHANGED, Options, fingerprint

    options = Options(line, False, LIMIT, loud=False, is_sandboxed=is_sandboxed, fingerprint=fingerprint(line))
    with tqdm(total=len(drivers), unit="race", disable=None, ascii=" =") as bar:
        for number, (path, driver) in enumerate(drivers.items(), 1):
            if bar.disable:
                print_text(f"race {number} of {len(drivers)}: {names[path]}\n", err=True)
            done[path][RACE] = await _score(driver, project, options)
            bar.update()
            if done[path][RACE].cause == CHANGED:
                break


async def _judge_all(
    names: dict[Path, str], jobs: int, limit: float, is_sandboxed: bool, done: Done
) -> dict[Path, str]:
    """Judge the answers, and return the drivers in the order of the notebooks."""
    drivers: dict[Path, str] = {}
    turn = asyncio.Semaphore(jobs)
    with tqdm(total=len(names), unit="notebook", disable=None, ascii=" =") as bar:

        async def judge_one(path: Path) -> None:
            async with turn:
                done[path], drivers[path] = await judge(path, limit, is_sandboxed)
            if drivers[path]:
                done[path][RACE] = Judged(Outcome.NOT_JUDGED, NOT_RACED, NOT_RACED)
            bar.update()
            if bar.disable:
                print_text(f"{len(done)} of {len(names)}: {names[path]}\n", err=True)

        async with asyncio.TaskGroup() as group:
            for path in names:
                group.create_task(judge_one(path))
    return {path: drivers[path] for path in names if drivers[path]}


async def _score(driver: str, project: Project, options: Options) -> Judged:
    """Run a race, and return the verdict and the score.

    If the driver failed or the race was not fair, the verdict is ``wrong``.
    """
    from tutorial.commands.racing import race

    with tempfile.TemporaryDirectory(prefix="tank-check-") as folder:
        path = Path(folder, "my_driver.py")
        path.write_bytes(driver.encode("utf-8", "surrogatepass"))
        try:
            entry = await race(path, path.name, None, project, options)
        except TutorialError as error:
            return Judged(Outcome.NOT_JUDGED, str(error), str(error))
    outcome = Outcome.WRONG if entry.note else Outcome.SCORED
    course = ". ".join(filter(None, (entry.result.course, entry.warning)))
    return Judged(outcome, entry.note or course, course, entry.result.score)
