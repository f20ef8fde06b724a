"""The command ``tank check``, which judges the answers in learners' notebooks."""

# ruff: noqa: PLC0415 - help must be fast

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tutorial.commands.options import LAYOUT, Seconds
from tutorial.commands.terminal import INTERRUPTED, until_asked
from tutorial.errors import TutorialError, printable
from tutorial.system.printing import print_text

if TYPE_CHECKING:
    from tutorial.commands.checking.report import Results
    from tutorial.commands.checking.run import Done

TOGETHER = 2  # maximum number of notebooks that are judged at the same time
LIMIT = 60.0  # [s] time limit for each answer


@click.command(short_help="Check the answers in learners' notebooks.")
@click.argument("notebooks", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path))
@click.option(
    "--jobs",
    type=click.IntRange(1, 64),
    default=TOGETHER,
    show_default=True,
    help="Judge this many notebooks at the same time.",
)
@click.option(
    "--limit",
    type=Seconds(min=0, min_open=True),
    default=LIMIT,
    show_default=True,
    metavar="SECONDS",
    help="Stop any answer that runs longer than SECONDS.",
)
@click.option(
    "--json", "as_json", is_flag=True, help="Print JSON, including the full text of each check, instead of a table."
)
@click.option(
    "--no-sandbox", is_flag=True, help="Run the answers without a sandbox. Do this only if you trust all of them."
)
@click.option(
    "--junit", type=click.File("wb", lazy=True), metavar="FILE", help="Also write a JUnit XML report to FILE."
)
@click.option("--layout", default="bend", show_default=True, help=LAYOUT)
def check(
    notebooks: tuple[Path, ...],
    jobs: int,
    limit: float,
    as_json: bool,
    no_sandbox: bool,
    junit: Any,
    layout: str,
) -> int:
    """Check the answers in NOTEBOOKS, which are files or folders.

    The command runs only the answers and the definitions that they need, in a sandbox. The drivers of step 11 get a
    score instead of a verdict: they race one after another, each for at most 40 s.

    The exit status is 1 if any answer is wrong, any answer or driver could not be judged, or any driver failed.
    Exercises that were not tried do not affect the exit status.
    """
    from tutorial.commands.checking import report
    from tutorial.commands.checking.messages import Outcome
    from tutorial.commands.checking.run import NOT_RACED, judge_and_race
    from tutorial.commands.checking.sandbox import need_sandbox
    from tutorial.system.paths import find_layout

    line = find_layout(layout)
    if junit is not None:
        junit.open()  # a click LazyFile: fails before judging if the report cannot be written
    paths = _found(notebooks)
    if not paths:
        raise TutorialError(f"there are no notebooks in {', '.join(map(str, notebooks))}")
    if not no_sandbox:
        need_sandbox()
    names = _names(paths)
    done: Done = {}
    interrupted = until_asked(judge_and_race(names, jobs, limit, not no_sandbox, line, done))
    results = [(names[path], done[path]) for path in paths if path in done]
    _show(results, as_json, not no_sandbox)
    if junit is not None:
        try:
            with junit as file:
                file.write(report.as_junit(results))
        except OSError as error:
            raise TutorialError(f"the JUnit report cannot be written: {error.strerror}.") from error
    if interrupted:
        judged = sum(all(each.cause != NOT_RACED for each in verdicts.values()) for verdicts in done.values())
        print_text(f"Interrupted: {len(paths) - judged} of {len(paths)} notebooks were not judged.\n", err=True)
        return INTERRUPTED
    fine = (Outcome.RIGHT, Outcome.NOT_TRIED, Outcome.SCORED)
    return int(any(judged.outcome not in fine for _, verdicts in results for judged in verdicts.values()))


def _show(results: Results, as_json: bool, is_sandboxed: bool) -> None:
    """Print the verdicts and a summary."""
    from rich.console import Console

    from tutorial.commands.checking import report

    if as_json:
        print_text(json.dumps(report.as_json(results, is_sandboxed), indent=2) + "\n")
    else:
        console = Console(highlight=False)
        console.print(report.table(results))
        console.print(*report.summary(results, is_sandboxed), sep="\n", markup=False)


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
