"""The catalogue of all exercises."""

from __future__ import annotations

import ast
import importlib
import pkgutil
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from tutorial import checks
from tutorial.ros.backend import ros_backend
from tutorial.system.paths import HOME

if TYPE_CHECKING:
    from tutorial.checks.exercise import Exercise

NEEDS_REAL_ROS = ("10_services", "services")  # in a sandbox, the notebooks are hidden, so the title has no number


@cache
def exercises() -> dict[str, tuple[Exercise, ...]]:
    """Return all exercises by notebook (such as ``1_tank_controller``), in the course's order.

    A notebook and its module here have the same name, except for the number. The module's ``__all__`` lists the
    exercises in the notebook's order. Modules without a notebook come last. With the pocket ROS 2, which has no
    services, the exercises about services are omitted.
    """
    names_of = exercise_names()
    if ros_backend() == "pocket":
        names_of = {title: names for title, names in names_of.items() if title not in NEEDS_REAL_ROS}
    return {
        title: tuple(getattr(importlib.import_module(f"{checks.__name__}.{name}"), name) for name in names)
        for title, names in names_of.items()
    }


def exercise_names(step: int | None = None) -> dict[str, list[str]]:
    """Return the names of a step's exercises, or of all exercises, by notebook.

    Each exercise has a module with the same name. The function imports none of these modules, so it works
    without rclpy.
    """
    notebooks = {path.stem.partition("_")[2]: path.stem for path in (HOME / "notebooks").glob("[0-9]*_*.ipynb")}
    modules = [each.name for each in pkgutil.iter_modules(checks.__path__) if not each.ispkg]
    listed = {notebooks.get(name, name): _listed(name) for name in modules}
    found = {title: [name for name in listed[title] if name in modules] for title in sorted(listed, key=_place)}
    prefix = "" if step is None else f"{step}_"
    return {title: names for title, names in found.items() if names and title.startswith(prefix)}


def _place(title: str) -> tuple[bool, int, str]:
    """Return a key that sorts notebooks by their numbers, and modules without a notebook after them."""
    number = title.partition("_")[0]
    return not number.isdecimal(), int(number) if number.isdecimal() else 0, title


def _listed(module: str) -> list[str]:
    """Read ``__all__`` from a module's source."""
    tree = ast.parse((Path(checks.__path__[0]) / f"{module}.py").read_text(encoding="utf-8"))
    assigned = (each for each in tree.body if isinstance(each, ast.Assign))
    values = [each.value for each in assigned if ast.unparse(each.targets[0]) == "__all__"]
    return list(ast.literal_eval(values[0])) if values else []
