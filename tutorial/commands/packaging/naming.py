"""Names of packages, as ROS 2 and Python allow them."""

from __future__ import annotations

import re
from importlib.util import find_spec
from keyword import iskeyword

from tutorial.errors import TutorialError

__all__ = ["check_name"]

VALID = re.compile(r"[a-z](_?[a-z0-9])+")


def check_name(name: str) -> None:
    """See to it that a package can have a name: one of REP 144's, which no Python module has yet.

    Raises:
        TutorialError: it cannot; the text says a name that is near.
    """
    if not VALID.fullmatch(name):
        rule = "Use lowercase letters, digits and single _, a letter first, and two characters at least."
        raise TutorialError(f"{name!r} cannot be a package's name.{_nearest(name)} {rule}")
    if iskeyword(name) or find_spec(name) is not None:
        mend = f"Take another name, such as {f'my_{name}'!r}."
        raise TutorialError(f"Python has a module, or a keyword, {name!r} already: one would hide the other. {mend}")


def _nearest(name: str) -> str:
    """Make a valid name of another one, and ask whether it was meant; empty where little of it would be left."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)  # between the words of CamelCase
    near = re.sub(r"[^a-z0-9]+", "_", words.lower()).strip("_0123456789")
    return f" Did you mean {near!r}?" if VALID.fullmatch(near) else ""
