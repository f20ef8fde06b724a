"""One frame of a program's view: the bodies, and the line of text below them."""

from collections.abc import Mapping

from tutorial.errors import TutorialError
from tutorial.program.item import Item
from tutorial.view.bodies import View

FEW = 3  # with more bodies than this, only bodies with faults get a line


def draw_frame(view: View, items: Mapping[str, Item], note: str, error: BaseException | None) -> None:
    """Draw the bodies that have changed, and write the line of text below the view.

    Args:
        view: the view, which already contains the bodies.
        items: the bodies by name.
        note: text at the start of the line; can be empty.
        error: the last error; None without errors.
    """
    for name, item in items.items():
        if item.take_dirty():
            view.update(name, item.body.data)
        view.show_stale(name, item.joints.stale())
    lines, readings = _describe_bodies(view, items)
    notes = (item.body.note for item in items.values())
    view.line("  |  ".join(filter(None, (note, _describe_error(error), *notes, *lines))), readings)
    view.flush()


def _describe_error(error: BaseException | None) -> str:
    if error is None:
        return ""
    return str(error) if isinstance(error, TutorialError) else f"{type(error).__name__}: {error}"


def _describe_bodies(view: View, items: Mapping[str, Item]) -> tuple[list[str], list[tuple[str, ...]]]:
    """Return a line about each body's messages, and rows with its sensors' measurements.

    If there are more than `FEW` bodies, count the bodies that follow their messages, and return a line for each of the
    first few bodies that don't.
    """
    watches = [item.joints for item in items.values()]
    fleet = [watch for watch in watches if watch.meters or watch.in_order]
    if len(fleet) <= FEW:
        return [watch.line() for watch in watches], [row for name in items for row in view.readings(name)]
    others = [watch for watch in fleet if not watch.in_order]
    count = f"{len(fleet) - len(others)} of {len(fleet)} bodies follow their messages"
    return [count, *(watch.line() for watch in others[:FEW])], []
