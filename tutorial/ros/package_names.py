"""Which names a ROS 2 package can have."""

import re
from importlib.util import find_spec
from keyword import iskeyword

from tutorial.errors import TutorialError

VALID = re.compile(r"[a-z](_?[a-z0-9])+")
"""What ROS 2 accepts as a package's name: REP 144."""


def check_package_name(name: str) -> None:
    """Check that a new package can have a name: it follows REP 144, and no Python module has it yet.

    Raises:
        TutorialError: it cannot have this name; the text suggests one.
    """
    if not VALID.fullmatch(name):
        rule = "Use lowercase letters, digits and single _, a letter first, and two characters at least."
        raise TutorialError(f"{name!r} cannot be a package's name.{_nearest(name)} {rule}")
    if iskeyword(name) or find_spec(name) is not None:
        advice = f"Choose another name, such as {f'my_{name}'!r}."
        raise TutorialError(f"Python already has a module or keyword {name!r}: one would hide the other. {advice}")


def _nearest(name: str) -> str:
    """Suggest a valid package name; empty where little of the given one would be left."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)  # between the words of CamelCase
    near = re.sub(r"[^a-z0-9]+", "_", words.lower()).strip("_0123456789")
    return f" Did you mean {near!r}?" if VALID.fullmatch(near) else ""
