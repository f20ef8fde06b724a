"""Which exercises are solved: remembered in a small file beside the notebook.

There is no account, and nothing leaves the folder. To begin anew, delete the file.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from datetime import date
from pathlib import Path
from typing import Any

__all__ = ["FILE", "read_progress", "remember"]

FILE = ".tank_progress.json"
VARIABLE = "TANK_PROGRESS"  # names another file, for tests

_NO_FILE = (FileNotFoundError, NotADirectoryError)


def remember(exercise: str) -> None:
    """Write down that an exercise is solved, if this is a notebook; the first time counts.

    A folder that cannot be written to is no reason for an exercise to fail: then it is not remembered.

    Args:
        exercise: its name.
    """
    if not _in_notebook():
        return
    path = _file(Path())
    solved, _ = read_progress()
    if exercise not in solved:
        with suppress(OSError):
            _write(path, {**solved, exercise: date.today().isoformat()})


def read_progress(folder: Path | None = None) -> tuple[dict[str, str], str]:
    """Return the exercises that are solved in a folder's notebooks.

    Args:
        folder: where the notebooks are; None for the one that this process works in.

    Returns:
        By the exercise's name, the day when it was solved; and what is wrong with the file, empty if it can be read.
    """
    path = _file(Path()) if folder is None else folder / FILE
    try:
        solved = json.loads(path.read_text(encoding="utf-8"))["solved"]
        return {str(name): date.fromisoformat(day).isoformat() for name, day in solved.items()}, ""
    except _NO_FILE:
        return {}, ""
    except Exception as error:  # noqa: BLE001 - it may be anything that somebody has written there
        return {}, f"{path.name} cannot be read, so nothing counts as solved: {type(error).__name__}: {error}"


def _file(folder: Path) -> Path:
    return Path(os.environ.get(VARIABLE) or folder / FILE)


def _in_notebook() -> bool:
    """Whether this process is a notebook's kernel."""
    ipython: Any = sys.modules.get("IPython")
    return ipython is not None and getattr(ipython.get_ipython(), "kernel", None) is not None


def _write(path: Path, solved: Mapping[str, str]) -> None:
    """Write the file whole, or not at all: two notebooks may be open, or the machine may stop."""
    with tempfile.NamedTemporaryFile("w", dir=path.parent, prefix=FILE, delete=False, encoding="utf-8") as file:
        file.write(json.dumps({"solved": dict(solved)}, indent=2) + "\n")
    try:
        Path(file.name).replace(path)
    except OSError:
        Path(file.name).unlink()
        raise
