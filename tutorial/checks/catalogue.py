"""The exercises that there are."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from pathlib import Path

from tutorial import checks
from tutorial.checks.exercise import Exercise
from tutorial.paths import HOME

__all__ = ["exercise_names", "exercises"]


@cache
def exercises() -> dict[str, tuple[Exercise, ...]]:
    """Return them in the course's order, by the notebook that they are in, such as ``1_tank_controller``.

    A notebook and its checks have the same name, but for the number. What has no notebook here comes last.
    """
    names = [each.name for each in pkgutil.iter_modules(checks.__path__) if each.name[0] != "_"]
    notebooks = {path.stem.partition("_")[2]: path for path in sorted((HOME / "notebooks").glob("[0-9]*_*.ipynb"))}
    found: dict[str, tuple[Exercise, ...]] = {}
    for name in [*(name for name in notebooks if name in names), *(name for name in names if name not in notebooks)]:
        values = vars(importlib.import_module(f"{checks.__name__}.{name}")).values()
        text = _text(notebooks[name]) if name in notebooks else ""
        own = {each for each in values if isinstance(each, Exercise)}.difference(*found.values())
        title = notebooks[name].stem if name in notebooks else name
        found[title] = tuple(sorted(own, key=lambda each: (_place(each, text), each.name)))
    return {title: own for title, own in found.items() if own}


def exercise_names(step: int | None = None) -> dict[str, list[str]]:
    """Return the names of a step's exercises, or of all, by the notebook that they are in."""
    prefix = "" if step is None else f"{step}_"
    return {title: [each.name for each in own] for title, own in exercises().items() if title.startswith(prefix)}


def _place(exercise: Exercise, text: str) -> int:
    """Say where in a notebook an exercise is checked; the end for one that is not."""
    place = text.find(f"{exercise.name}.check(")
    return place if place >= 0 else len(text)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:  # the process that judges strangers' answers may not read it
        return ""
