"""What goes wrong, said so that the reader knows the mend."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

__all__ = ["TutorialError", "WrongThreadError", "did_you_mean"]


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
