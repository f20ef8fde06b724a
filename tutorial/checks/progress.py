"""The learner's progress: a small file beside the notebook lists the solved exercises.

There is no account, and nothing leaves the folder. Delete the file to start over.
"""

import os
import sys
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from datetime import date
from html import escape
from pathlib import Path
from typing import Any

import msgspec

FILE = ".tank_progress.json"
VARIABLE = "TANK_PROGRESS"  # environment variable in which tests set the path of a different file
LARGEST = 2**20  # [bytes], a thousand times the usual size


class _File(msgspec.Struct):
    """The content of the file: the day when each exercise was solved. A value that is not a date stays unchanged."""

    solved: dict[str, Any]


UNREADABLE = (OSError, RecursionError, msgspec.MsgspecError)  # reading a broken file raises one of these


def remember(exercise: str) -> None:
    """Record that an exercise is solved, if this process is a notebook's kernel. A recorded date never changes.

    If the file cannot be read or written, nothing is recorded and the file stays unchanged, but the check still
    succeeds.

    Args:
        exercise: the exercise's name.
    """
    path = _file(Path())
    if _in_notebook():
        with suppress(*UNREADABLE):
            solved = _read(path)
            if exercise not in solved:
                _write(path, {**solved, exercise: date.today()})


def read_progress(folder: Path | None = None) -> tuple[dict[str, Any], str]:
    """Return the exercises that are solved in a folder's notebooks.

    Args:
        folder: the notebooks' folder; None for the current directory.

    Returns:
        A dict from each solved exercise's name to the day when it was solved, and an error message, which is empty if
        the file is valid.
    """
    path = _file(Path()) if folder is None else folder / FILE
    try:
        return _read(path), ""
    except UNREADABLE as error:
        return {}, (
            f"{path.name} cannot be read, so no exercise counts as solved: {error}. To start over, delete the file."
        )


class Overview:
    """The exercises of the course, and which of them are solved.

    Args:
        exercises: the names of the exercises, by notebook.
        folder: the notebooks' folder; None for the current directory.
    """

    def __init__(self, exercises: Mapping[str, Sequence[str]], folder: Path | None = None) -> None:
        self._solved, problem = read_progress(folder)
        self._exercises = exercises
        names = [name for own in exercises.values() for name in own]
        self._most = len(names)
        self._count = sum(name in self._solved for name in names)
        exercises_are = "exercises are" if len(names) != 1 else "exercise is"
        self._last_lines = [f"{self._count} of {len(names)} {exercises_are} solved.", *filter(None, [problem])]

    def __repr__(self) -> str:
        rows = [
            (notebook * (i == 0), name, self._state(name))
            for notebook, own in self._exercises.items()
            for i, name in enumerate(own)
        ]
        widths = [max((len(row[i]) for row in rows), default=0) for i in (0, 1)]
        lines = [f"{notebook:{widths[0]}}  {name:{widths[1]}}  {state}" for notebook, name, state in rows]
        return "\n".join([*lines, *self._last_lines])

    def _repr_html_(self) -> str:
        rows = "".join(self._row(notebook, own) for notebook, own in self._exercises.items() if own)
        bar = f'<progress max="{self._most or 1}" value="{self._count}" style="width: 16em"></progress>'
        return f"<p>{bar} {'<br>'.join(map(escape, self._last_lines))}</p><table>{rows}</table>"

    def _row(self, notebook: str, names: Sequence[str]) -> str:
        """Return one notebook's row: a link to the notebook, and its exercises."""
        link = f'<a href="{escape(notebook)}.ipynb">{escape(notebook)}</a>'
        cell = '<td style="text-align: left">'
        return f"<tr>{cell}{link}</td>{cell}{' &nbsp; '.join(map(self._exercise, names))}</td></tr>"

    def _exercise(self, name: str) -> str:
        mark, opacity = ("✓", 1) if name in self._solved else ("○", 0.65)
        return (
            f'<span title="{escape(self._state(name))}" style="opacity: {opacity}; white-space: nowrap">'
            f"{mark} <code>{escape(name)}</code></span>"
        )

    def _state(self, name: str) -> str:
        return f"solved on {self._solved[name]}" if name in self._solved else "not yet"


def _file(folder: Path) -> Path:
    return Path(os.environ.get(VARIABLE) or folder / FILE).resolve()


def _in_notebook() -> bool:
    """Return whether this process is a notebook's kernel."""
    ipython: Any = sys.modules.get("IPython")
    return ipython is not None and getattr(ipython.get_ipython(), "kernel", None) is not None


def _read(path: Path) -> dict[str, Any]:
    """Return the dates in a file, or an empty dict if the file doesn't exist.

    Raises:
        OSError, RecursionError, msgspec.MsgspecError: the file cannot be read, or has the wrong format.
    """
    if not path.exists():
        return {}
    if not path.is_file() or path.stat().st_size > LARGEST:  # reading a pipe or device could block or never end
        raise OSError("it is not a regular file, or it is larger than 1 MB")
    return msgspec.json.decode(path.read_bytes(), type=_File).solved


def _write(path: Path, solved: dict[str, Any]) -> None:
    """Replace the file atomically, in case another notebook writes it at the same time, or the machine crashes."""
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=FILE, delete=False) as file:
        file.write(msgspec.json.format(msgspec.json.encode(_File(solved))) + b"\n")
    try:
        Path(file.name).replace(path)
    except OSError:
        Path(file.name).unlink()
        raise
