"""The command ``tank race``: a learner's node drives the tank along a line and gets a score."""

# ruff: noqa: PLC0415 - help must be fast

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import click

from tutorial.commands.options import LAYOUT
from tutorial.commands.terminal import INTERRUPTED, until_asked
from tutorial.errors import TutorialError, printable
from tutorial.race.rules import LIMIT
from tutorial.system.printing import print_text

if TYPE_CHECKING:
    from rich.table import Table

    from tutorial.commands.racing import Entry
    from tutorial.program.project import Project

FILE = click.Path(exists=True, dir_okay=False, path_type=Path)


@click.command(short_help="Let your own node drive the tank along a line, and score the race.")
@click.argument("drivers", nargs=-1, required=True, metavar="DRIVER...", type=FILE)
@click.option("--layout", default="bend", show_default=True, help=LAYOUT)
@click.option(
    "--limit", type=click.FloatRange(1, LIMIT), default=LIMIT, show_default=True, metavar="SECONDS",
    help="End each race after SECONDS, for example to try out a driver.",
)  # fmt: skip
@click.option("--sandbox", is_flag=True, help="Run the drivers in a sandbox, where they cannot change any files.")
@click.option("--view", is_flag=True, help="Show a 3D view.")
@click.option(
    "--json", "scoreboard", type=click.File("a"), metavar="FILE",
    help="Append a line of JSON to FILE for each driver.",
)  # fmt: skip
@click.option(
    "--replay", type=click.Path(file_okay=False, path_type=Path), metavar="DIR",
    help="For each driver, write a page to DIR that replays its race.",
)  # fmt: skip
def race(drivers: tuple[Path, ...], layout: str, scoreboard: TextIO | None, replay: Path | None, **how: Any) -> int:
    """Score each DRIVER, a Python file with a node that publishes on /joy.

    A driver sees the line through the tank's camera, on /Tank/camera/image. It follows the line to its end, turns the
    turret, and touches the orange rail with the barrel. If the barrel does not touch the rail, the race
    ends after 40 s, after 10 s without progress, or when the driver's program ends. The table is sorted by score; the
    maximum is 100.

    The exit status is 1 if a driver failed or a race was not fair.
    """
    from rich.console import Console

    from tutorial.commands.checking.sandbox import need_sandbox
    from tutorial.system.paths import find_layout

    line = find_layout(layout)
    if how["sandbox"]:
        need_sandbox("omit --sandbox")
    if replay is not None:
        try:
            replay.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise TutorialError(f"the folder {replay} cannot be created: {error.strerror}.") from error
    project = race_project(line)
    entries: list[Entry] = []
    try:
        interrupted = until_asked(_race_all(drivers, project, line, entries, scoreboard, replay, **how))
    finally:
        if entries:
            Console(highlight=False).print(table(entries))
            print_text(remarks(entries))
    if interrupted:
        print_text(f"Interrupted: {len(drivers) - len(entries)} of {len(drivers)} races were not finished.\n", err=True)
        return INTERRUPTED
    return int(any(entry.note for entry in entries))


def table(entries: list[Entry]) -> Table:
    """Return a table of the entries, with the best score first."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    rows = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("driver", "layout", "progress", "time", "end", "contacts", "score"):
        rows.add_column(heading, justify="left" if heading in ("driver", "layout", "end") else "right", overflow="fold")
    for entry in sorted(entries, key=lambda each: -each.result.score):
        result = entry.result
        names = (printable(entry.driver), printable(entry.layout))
        seen = (f"{result.progress:.0%}", f"{result.seconds:.1f} s", result.end, str(result.contacts))
        rows.add_row(*map(Text, names), *seen, f"{result.score:.1f}")
    return rows


def remarks(entries: list[Entry]) -> str:
    """List each race's problems, and the things that the tank touched."""
    lines = []
    for entry in entries:
        said = [entry.note, entry.warning, *(f"the tank has touched {each}" for each in entry.result.touched)]
        lines += [f"{printable(entry.driver)}: {each}\n" for each in said if each]
    return "".join(lines)


def names_of(drivers: tuple[Path, ...]) -> list[str]:
    """Return the drivers' file names or, if two are the same, the files' paths relative to their common folder."""
    if len({path.name for path in drivers}) == len(set(drivers)):
        return [path.name for path in drivers]
    absolute = [Path(os.path.abspath(path)) for path in drivers]  # noqa: PTH100 - keep a link's own name
    common = os.path.commonpath([path.parent for path in absolute])
    return [str(path.relative_to(common)) for path in absolute]


async def _race_all(
    drivers: tuple[Path, ...],
    project: Project,
    line: Path,
    entries: list[Entry],
    scoreboard: TextIO | None,
    replay: Path | None,
    view: bool,
    sandbox: bool,
    limit: float,
) -> None:
    """Run the races one after another, because simultaneous races would slow each other down."""
    from tutorial.commands.racing import CHANGED, NO_START, Entry, Options, fingerprint, race
    from tutorial.race.rules import Result

    is_league = len(drivers) > 1
    options = Options(line, view, limit, not is_league, sandbox, fingerprint(line))
    for number, (path, name) in enumerate(zip(drivers, names_of(drivers)), start=1):
        if is_league:
            print_text(f"{number} of {len(drivers)}: {printable(name)}\n", err=True)
        page = f"{name.removesuffix('.py').replace(os.sep, '-')}-{line.stem}.html"
        try:
            entry = await race(path, name, None if replay is None else replay / page, project, options)
        except TutorialError as error:
            if not is_league:
                raise
            entry = Entry(name, line.stem, Result(end=NO_START), str(error))
        entries.append(entry)
        if scoreboard is not None:
            scoreboard.write(json.dumps(entry.as_dict()) + "\n")
            scoreboard.flush()
        if entry.result.foul == CHANGED and number < len(drivers):
            raise TutorialError(f"{CHANGED}: restore them, and then race the remaining drivers.")


def race_project(line: Path) -> Project:
    """Load the race project that came with the tutorial, not a learner's copy, and use this line in it.

    Raises:
        TutorialError: this machine cannot render camera images, or the line is not valid.
    """
    _check_pictures()  # first, because importing MuJoCo can fail as well
    from tutorial import ros_backend
    from tutorial.program.project import Project
    from tutorial.system.paths import original

    ros_backend()  # otherwise, an error would blame the first controller that imports rclpy
    return Project.load(original() / "project" / "race.yaml").with_model("Line", line)


def _check_pictures() -> None:
    """Raise an error if this machine cannot render camera images."""
    from tutorial.commands.doctor import mujoco

    found = mujoco()
    if found.level != "ok":
        raise TutorialError(f"a race needs camera images, but MuJoCo can't render: {found.text}. {found.fix}.")
