"""The command ``tank check``, which judges the answers in learners' notebooks."""

# ruff: noqa: PLC0415 - help must be fast

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tutorial.commands.options import Seconds
from tutorial.commands.terminal import INTERRUPTED, until_asked
from tutorial.errors import TutorialError, printable
from tutorial.system.printing import print_text

if TYPE_CHECKING:
    from tutorial.commands.checking.messages import Judged

    Done = dict[Path, dict[str, Judged]]

TOGETHER = 2  # maximum number of notebooks that are judged at the same time
LIMIT = 60.0  # [s] time limit for each answer


@click.command(short_help="Check the answers in learners' notebooks.")
@click.argument("notebooks", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path))
@click.option(
    "--jobs",
    type=click.IntRange(1, 64),
    default=TOGETHER,
    show_default=True,
    help="Judge this many notebooks at a time.",
)
@click.option(
    "--limit",
    type=Seconds(min=0, min_open=True),
    default=LIMIT,
    show_default=True,
    metavar="SECONDS",
    help="Stop an answer that takes longer than this.",
)
@click.option(
    "--json", "as_json", is_flag=True, help="Print JSON, with the full text of each check, instead of the table."
)
@click.option("--no-sandbox", is_flag=True, help="Run the answers without a sandbox. Use this only if you trust them.")
@click.option(
    "--junit", type=click.File("wb", lazy=True), metavar="FILE", help="Also write a JUnit XML report to FILE."
)
def check(notebooks: tuple[Path, ...], jobs: int, limit: float, as_json: bool, no_sandbox: bool, junit: Any) -> int:
    """Check the answers in NOTEBOOKS, which are files or folders.

    Only the answers and the definitions that they need are run, in a sandbox.
    The exit status is 1 if any answer is wrong or could not be judged. Exercises that were not tried do not count.
    """
    from rich.console import Console

    from tutorial.commands.checking import report
    from tutorial.commands.checking.messages import Outcome
    from tutorial.commands.checking.sandbox import need_sandbox

    if junit is not None:
        junit.open()  # a click LazyFile: fail before judging if it cannot be written
    paths = _found(notebooks)
    if not paths:
        raise TutorialError(f"there is no notebook in {', '.join(map(str, notebooks))}")
    if not no_sandbox:
        need_sandbox()
    names = _names(paths)
    done: Done = {}
    interrupted = until_asked(_judge_all(names, jobs, limit, not no_sandbox, done))
    results = [(names[path], done[path]) for path in paths if path in done]
    if as_json:
        print_text(json.dumps(report.as_json(results, not no_sandbox), indent=2) + "\n")
    else:
        console = Console(highlight=False)
        console.print(report.table(results))
        console.print(*report.summary(results, not no_sandbox), sep="\n", markup=False)
    if junit is not None:
        try:
            with junit as file:
                file.write(report.as_junit(results))
        except OSError as error:
            raise TutorialError(f"the JUnit report cannot be written: {error.strerror}.") from error
    if interrupted:
        print_text(f"Interrupted: {len(paths) - len(done)} of {len(paths)} notebooks were not judged.\n", err=True)
        return INTERRUPTED
    fine = (Outcome.RIGHT, Outcome.NOT_TRIED)
    return int(any(judged.outcome not in fine for _, verdicts in results for judged in verdicts.values()))


def _found(given: Sequence[Path]) -> list[Path]:
    """Find the notebooks, without duplicates. Search folders recursively, except for Jupyter's checkpoints."""
    found: dict[Path, None] = {}
    for path in given:
        inner = sorted(path.rglob("*.ipynb")) if path.is_dir() else [path]
        found |= dict.fromkeys(each for each in inner if ".ipynb_checkpoints" not in each.parts)
    return list(found)


def _names(paths: Sequence[Path]) -> dict[Path, str]:
    """Name each notebook by its path below the common folder, and escape control characters."""
    absolute = [Path(os.path.abspath(path)) for path in paths]  # noqa: PTH100 - keep a link's own name
    common = Path(os.path.commonpath([path.parent for path in absolute]))
    return {path: printable(str(whole.relative_to(common))) for path, whole in zip(paths, absolute)}


async def _judge_all(names: dict[Path, str], jobs: int, limit: float, is_sandboxed: bool, done: Done) -> None:
    """Judge notebooks, `jobs` at a time. Show a progress bar or, without a terminal, a line for each notebook."""
    from tqdm import tqdm

    from tutorial.commands.checking.submission import judge

    turn = asyncio.Semaphore(jobs)
    with tqdm(total=len(names), unit="notebook", disable=None, ascii=" =") as bar:

        async def judge_one(path: Path) -> None:
            async with turn:
                done[path] = await judge(path, limit, is_sandboxed)
            bar.update()
            if bar.disable:
                print_text(f"{len(done)} of {len(names)}: {names[path]}\n", err=True)

        async with asyncio.TaskGroup() as group:
            for path in names:
                group.create_task(judge_one(path))
