"""What goes wrong, said so that the reader knows the mend."""

from __future__ import annotations

import traceback
from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

__all__ = ["TutorialError", "WrongThreadError", "did_you_mean", "tell"]


class TutorialError(Exception):
    """Base of every error that the library raises on purpose.

    Its text is made for the learner: what was given, what was expected, and the mend.
    """


class WrongThreadError(TutorialError):
    """Something that belongs to one thread was touched from another."""


def did_you_mean(given: str, valid: Iterable[str]) -> str:
    """End a message about an unknown name: the nearest valid name, and all of them.

    Args:
        given: the name that is not known.
        valid: the names that are.

    Returns:
        ``" Did you mean 'x'? Known are 'x', 'y'."``, with a leading space so that it can be appended to a sentence.
    """
    names = sorted(valid)
    if not names:
        return " There are none."
    near = get_close_matches(given, names, n=1)
    hint = f" Did you mean {near[0]!r}?" if near else ""
    return f"{hint} Known are {', '.join(map(repr, names))}."


def tell(error: Exception, file: str) -> str:
    """Say in one line what went wrong in somebody's file, and where: the innermost place that is in it.

    Args:
        error: what was raised.
        file: the path of the file that the reader can mend.

    Returns:
        For instance ``"hello_world.py, line 8, in control: ZeroDivisionError: division by zero"``.
    """
    text = f"{type(error).__name__}: {error}"
    if isinstance(error, SyntaxError) and error.filename == file:
        return f"{Path(file).name}, line {error.lineno}: {type(error).__name__}: {error.msg}"
    places = [place for place in traceback.extract_tb(error.__traceback__) if place.filename == file]
    if not places:
        return f"{Path(file).name}: {text}"
    within = "" if places[-1].name == "<module>" else f", in {places[-1].name}"
    return f"{Path(file).name}, line {places[-1].lineno}{within}: {text}"
