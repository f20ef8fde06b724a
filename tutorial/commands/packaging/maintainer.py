"""Who maintains a package that is made on this machine."""

from __future__ import annotations

import re
import subprocess
from typing import NamedTuple

__all__ = ["NOBODY", "Maintainer", "find_maintainer"]

LONGEST = 100  # characters
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
    fits = found.name.isprintable() and len(found.name) <= LONGEST and len(found.email) <= LONGEST
    return found if found.name and fits and EMAIL.fullmatch(found.email) else NOBODY


def _ask_git(setting: str) -> str:
    try:
        done = subprocess.run(["git", "config", setting], capture_output=True, timeout=5, check=False)
    except (OSError, subprocess.TimeoutExpired):  # there is no git
        return ""
    return done.stdout.decode("utf-8", errors="replace").strip()
