"""Where the tutorial's files are: projects, launch files, notebooks, drives."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path

from tutorial.errors import TutorialError, did_you_mean

__all__ = ["HOME", "find_drive", "find_launch_file", "find_project", "with_own_commands"]

HOME = Path(__file__).resolve().parent.parent


def find_project(given: str) -> Path:
    """Find a project file: a path, or the name of one of the tutorial's own, such as ``step3``.

    Raises:
        TutorialError: there is no such project; the text names the nearest.
    """
    return _find(given, HOME / "project", ".yaml", "project")


def find_drive(given: str) -> Path:
    """Find a drive file: a path, or the name of one of the tutorial's own, such as ``tour``.

    Raises:
        TutorialError: there is no such drive; the text names the nearest.
    """
    return _find(given, HOME / "project" / "drives", ".yaml", "drive")


def find_launch_file(given: str) -> Path:
    """Find a launch file: a path, or the name of one of the tutorial's own, such as ``step3``.

    Raises:
        TutorialError: there is no such launch file; the text names the nearest.
    """
    return _find(given, HOME / "launch_py", ".launch.py", "launch file")


def with_own_commands(environment: Mapping[str, str]) -> dict[str, str]:
    """Let a process find the commands that are installed beside this Python, such as ``tank``, activated or not."""
    commands = (str(Path(sys.executable).parent), environment.get("PATH", os.defpath))
    return {**environment, "PATH": os.pathsep.join(commands)}


def _find(given: str, folder: Path, suffix: str, what: str) -> Path:
    if Path(given).is_file():
        if not given.endswith(suffix):
            raise TutorialError(f"{given!r} is no {what}: the name of one ends in {suffix!r}.")
        return Path(given)
    if (folder / f"{given}{suffix}").is_file():
        return folder / f"{given}{suffix}"
    beside = Path(given).parent
    wanted = Path(given).name
    if wanted == given or not beside.is_dir():
        known = [path.name.removesuffix(suffix) for path in folder.glob(f"*{suffix}")]
        wanted = wanted.removesuffix(suffix)
    else:
        known = [path.name for path in beside.glob(f"*{suffix}")]
    raise TutorialError(f"there is no {what} {given!r}.{did_you_mean(wanted, known)}")
