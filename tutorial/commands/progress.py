"""The command ``tank progress``."""

# ruff: noqa: PLC0415 - help must be fast

from __future__ import annotations

from pathlib import Path

import click

from tutorial.errors import TutorialError
from tutorial.printing import say


@click.command(short_help="Show which exercises are solved.")
@click.argument("folder", required=False, type=click.Path(file_okay=False, path_type=Path))
def progress(folder: Path | None) -> None:
    """Show which exercises are solved in the notebooks of FOLDER; without it, of the course folder one is in."""
    from tutorial.checks.catalogue import exercise_names
    from tutorial.paths import HOME, is_folder
    from tutorial.progress import FILE, Overview

    if folder is not None and not is_folder(folder):
        raise TutorialError(f"there is no folder {str(folder)!r}")
    places = [Path(), Path("notebooks")] if folder is None else [folder, folder / "notebooks"]
    default = HOME / "notebooks" if folder is None else folder
    place = next((place for place in places if (place / FILE).exists()), default)
    say(f"{Overview(exercise_names(), place)!r}\n")
