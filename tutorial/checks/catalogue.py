"""The exercises that there are."""

import importlib
import pkgutil
from functools import cache

from tutorial import checks
from tutorial.checks.exercise import Exercise
from tutorial.paths import HOME


@cache
def exercises() -> dict[str, tuple[Exercise, ...]]:
    """Return them in the course's order, by the notebook that they are in, such as ``1_tank_controller``.

    A notebook and a module here have the same name, but for the number; the module lists their exercises in the
    notebook's order, in ``__all__``. What has no notebook here comes last.
    """
    notebooks = {path.stem.partition("_")[2]: path.stem for path in (HOME / "notebooks").glob("[0-9]*_*.ipynb")}
    titles = {each.name: notebooks.get(each.name, each.name) for each in pkgutil.iter_modules(checks.__path__)}
    found: dict[str, tuple[Exercise, ...]] = {}
    for name in sorted((name for name in titles if name[0] != "_"), key=titles.__getitem__):
        module = importlib.import_module(f"{checks.__name__}.{name}")
        listed = [vars(module)[each] for each in getattr(module, "__all__", ())]
        if own := tuple(each for each in listed if isinstance(each, Exercise)):
            found[titles[name]] = own
    return found


def exercise_names(step: int | None = None) -> dict[str, list[str]]:
    """Return the names of a step's exercises, or of all, by the notebook that they are in."""
    prefix = "" if step is None else f"{step}_"
    return {title: [each.name for each in own] for title, own in exercises().items() if title.startswith(prefix)}
