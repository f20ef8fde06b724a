"""Check names for new ROS 2 packages."""

import re
from importlib.util import find_spec
from keyword import iskeyword

from tutorial.errors import TutorialError

VALID = re.compile(r"[a-z](_?[a-z0-9])+")
"""Package names that ROS 2 accepts (see REP 144)."""


def check_package_name(name: str) -> None:
    """Check a name for a new package: it must follow REP 144, and no Python module may have the same name.

    Raises:
        TutorialError: the package cannot have this name; the error suggests another name.
    """
    if not VALID.fullmatch(name):
        rule = "Use at least two characters: lowercase letters, digits and single underscores, starting with a letter."
        raise TutorialError(f"{name!r} is not a valid package name.{_nearest(name)} {rule}")
    if iskeyword(name) or find_spec(name) is not None:
        advice = f"Choose a different name, such as {f'my_{name}'!r}."
        raise TutorialError(
            f"Python already has a module or keyword {name!r}, and a package cannot share its name. {advice}"
        )


def _nearest(name: str) -> str:
    """Suggest a valid package name; return ``""`` if too little of the given name would be left."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)  # between the words of a CamelCase name
    near = re.sub(r"[^a-z0-9]+", "_", words.lower()).strip("_0123456789")
    return f" Did you mean {near!r}?" if VALID.fullmatch(near) else ""
