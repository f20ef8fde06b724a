"""Which exercises are solved: remembered in a small file beside the notebook, and shown in a cell or at a terminal.

There is no account, and nothing leaves the folder. To begin anew, delete the file.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from datetime import date
from html import escape
from pathlib import Path
from typing import Any

import msgspec

__all__ = ["FILE", "Overview", "read_progress", "remember"]

FILE = ".tank_progress.json"
VARIABLE = "TANK_PROGRESS"  # names another file, for tests
LARGEST = 2**20  # [bytes] a thousand times what such a file has


class _File(msgspec.Struct):
    """What the file looks like."""

    solved: dict[str, Any]


UNREADABLE = (OSError, RecursionError, msgspec.MsgspecError)
"""What is raised for a file that cannot be read, or is not such a file."""


def remember(exercise: str) -> None:
    """Write down that an exercise is solved, if this is a notebook; the first time counts.

    A file that cannot be read or written is no reason for an exercise to fail: then it is not remembered, and what is
    there stays as it is.

    Args:
        exercise: its name.
    """
    path = _file(Path())
    if _in_notebook():
        with suppress(*UNREADABLE):
            entries = _read(path)
            if exercise not in entries:
                _write(path, {**entries, exercise: date.today().isoformat()})


def read_progress(folder: Path | None = None) -> tuple[dict[str, str], str]:
    """Return the exercises that are solved in a folder's notebooks.

    Args:
        folder: where the notebooks are; None for the one that this process works in.

    Returns:
        By the exercise's name, the day when it was solved; and what is wrong with the file, empty if nothing is.
    """
    path = _file(Path()) if folder is None else folder / FILE
    try:
        entries = _read(path)
    except UNREADABLE as error:
        return {}, f"{path.name} cannot be read, so nothing counts as solved: {error}. Delete it to begin anew."
    solved = {name: day for name, day in entries.items() if _is_day(day)}
    odd = [name for name in entries if name not in solved]
    return solved, f"{path.name} has no day for {', '.join(odd)[:200]}." if odd else ""


class Overview:
    """The exercises of the course, and which of them are solved.

    Args:
        exercises: their names, by the notebook that they are in.
        folder: where the notebooks are; None for the one that this process works in.
    """

    def __init__(self, exercises: Mapping[str, Sequence[str]], folder: Path | None = None) -> None:
        self.solved, self.problem = read_progress(folder)
        self._exercises = exercises

    def __repr__(self) -> str:
        rows = list(self._rows())
        widths = [max(len(row[i]) for row in rows) for i in (0, 1)]
        lines = [f"{notebook:{widths[0]}}  {name:{widths[1]}}  {state}" for notebook, name, state in rows]
        return "\n".join([*lines, *self._last_lines()])

    def _repr_html_(self) -> str:
        cell = '<td style="text-align: left">'
        rows = "".join(
            f"<tr>{cell}{escape(notebook)}</td>{cell}<code>{escape(name)}</code></td>"
            f"{cell}{'✓ ' * (name in self.solved)}{escape(state)}</td></tr>"
            for notebook, name, state in self._rows()
        )
        return f"<table>{rows}</table>{'<br>'.join(map(escape, self._last_lines()))}"

    def _rows(self) -> Iterator[tuple[str, str, str]]:
        """Yield the notebook, where a new one begins, the exercise, and how it stands."""
        for notebook, names in self._exercises.items():
            for i, name in enumerate(names):
                yield (
                    "" if i else notebook,
                    name,
                    f"solved on {self.solved[name]}" if name in self.solved else "not yet",
                )

    def _last_lines(self) -> list[str]:
        names = [name for own in self._exercises.values() for name in own]
        solved = sum(name in self.solved for name in names)
        exercises = "exercises are" if len(names) != 1 else "exercise is"
        return [f"{solved} of {len(names)} {exercises} solved.", *filter(None, [self.problem])]


def _file(folder: Path) -> Path:
    return Path(os.environ.get(VARIABLE) or folder / FILE)


def _in_notebook() -> bool:
    """Whether this process is a notebook's kernel."""
    ipython: Any = sys.modules.get("IPython")
    return ipython is not None and getattr(ipython.get_ipython(), "kernel", None) is not None


def _is_day(text: Any) -> bool:
    with suppress(TypeError, ValueError):
        return isinstance(text, str) and date.fromisoformat(text).isoformat() == text
    return False


def _read(path: Path) -> dict[str, Any]:
    """Return what a file has, whatever it is; nothing where there is none.

    Raises:
        OSError, RecursionError, msgspec.MsgspecError: it cannot be read, or is not such a file.
    """
    if not path.exists():
        return {}
    if not path.is_file() or path.stat().st_size > LARGEST:
        raise OSError("it is no file of at most 1 MB")
    return msgspec.json.decode(path.read_bytes(), type=_File).solved


def _write(path: Path, solved: Mapping[str, Any]) -> None:
    """Write the file whole, or not at all: two notebooks may be open, or the machine may stop."""
    with tempfile.NamedTemporaryFile("w", dir=path.parent, prefix=FILE, delete=False, encoding="utf-8") as file:
        file.write(json.dumps({"solved": dict(solved)}, indent=2) + "\n")
    try:
        Path(file.name).replace(path)
    except OSError:
        Path(file.name).unlink()
        raise
