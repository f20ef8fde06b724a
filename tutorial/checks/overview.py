"""How far somebody has come with the exercises, to be looked at in a cell or at a terminal."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

from tutorial.checks.catalogue import exercises
from tutorial.checks.progress import read_progress

__all__ = ["Overview"]


class Overview:
    """The exercises of the course, and which of them are solved.

    Args:
        folder: where the notebooks are; None for the one that this process works in.
        step: the number of the only step to show; None for all.
    """

    def __init__(self, folder: Path | None = None, step: int | None = None) -> None:
        self.solved, self.problem = read_progress(folder)
        shown = "" if step is None else f"{step}_"
        self._exercises = {notebook: own for notebook, own in exercises().items() if notebook.startswith(shown)}

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
        for notebook, own in self._exercises.items():
            for i, exercise in enumerate(own):
                day = self.solved.get(exercise.name)
                yield "" if i else notebook, exercise.name, f"solved on {day}" if day else "not yet"

    def _last_lines(self) -> list[str]:
        names = [exercise.name for own in self._exercises.values() for exercise in own]
        solved = sum(name in self.solved for name in names)
        exercises = "exercises are" if len(names) != 1 else "exercise is"
        return [f"{solved} of {len(names)} {exercises} solved.", *filter(None, [self.problem])]
