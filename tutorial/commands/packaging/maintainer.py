"""Who maintains a package that is made on this machine."""

from __future__ import annotations

import re
import subprocess
from typing import NamedTuple

__all__ = ["NOBODY", "Maintainer", "find_maintainer"]

EMAIL = re.compile(r"[\w%+-]+(\.[\w%+-]+)*@[A-Za-z0-9-]+(\.[A-Za-z0-9-]+)*\.[A-Za-z]{2,}", re.ASCII)
"""What catkin_pkg, with which colcon reads a package.xml, takes for an address."""


class Maintainer(NamedTuple):
    """A person with an address for mail."""

    name: str
    email: str


NOBODY = Maintainer("Your Name", "you@example.com")
"""Who stands there until the learner writes a name in its place."""


def find_maintainer() -> Maintainer:
    """Ask git who works here; `NOBODY`, where it does not know, or what it says can stand in no package.xml."""
    found = Maintainer(_ask_git("user.name"), _ask_git("user.email"))
    return found if found.name.isprintable() and found.name and EMAIL.fullmatch(found.email) else NOBODY


def _ask_git(setting: str) -> str:
    try:
        return subprocess.run(["git", "config", setting], capture_output=True, text=True, check=False).stdout.strip()
    except OSError:  # there is no git
        return ""
