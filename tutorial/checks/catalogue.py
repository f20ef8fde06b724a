"""The exercises that there are."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from pathlib import Path

from tutorial import checks
from tutorial.checks.exercise import Exercise
from tutorial.paths import HOME

__all__ = ["exercises"]


@cache
def exercises() -> dict[str, tuple[Exercise, ...]]:
    """Return them by the file of the step that they belong to, such as ``tank_controller``, in the course's order.

    That is the order of the numbered notebooks; what belongs to none of them comes last.
    """
    notebooks = sorted((HOME / "notebooks").glob("[0-9]*_*.ipynb"))
    order = [path.stem.partition("_")[2] for path in notebooks]
    names = [each.name for each in pkgutil.iter_modules(checks.__path__) if each.name[0] != "_"]
    found = {}
    for name in sorted(names, key=lambda name: (name not in order, name in order and order.index(name), name)):
        values = vars(importlib.import_module(f"{checks.__name__}.{name}")).values()
        text = _text(notebooks[order.index(name)]) if name in order else ""
        own = {each for each in values if isinstance(each, Exercise)}
        found[name] = tuple(sorted(own, key=lambda each: (text.find(f"{each.name}.check("), each.name)))
    return {name: own for name, own in found.items() if own}


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:  # another process may not be allowed to read it
        return ""
