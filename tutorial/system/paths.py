"""Where the tutorial's files are: projects, launch files, notebooks, drives, models.

A folder that holds them is a *course folder*. There are three kinds: a checkout; the one within an installed package,
which is never written to; and a learner's own, which ``tank lab`` copies from that. Which is meant depends on where one
works, and is decided once in a process: the nearest course folder from the current directory upwards; else the
checkout that the package is in; else the package's own.
"""

import os
import sys
from collections.abc import Mapping
from pathlib import Path

from tutorial.errors import TutorialError, did_you_mean

COURSE = ("launch_py", "notebooks", "project")
"""What a course folder has in it."""

ROOT = 0  # the user

OTHER_MODELS = (".urdf", ".mjcf", ".xacro")
"""Suffixes of models, besides .xml. Reading a xacro file raises an error that says what to do."""

PACKAGE = Path(__file__).resolve().parents[1]
"""The folder of the package ``tutorial``; what is above it is where Python finds it."""

SHIPPED = PACKAGE / "_files"
"""The course folder within an installed package. A checkout has none."""


def is_file(path: Path) -> bool:
    """Whether a path that somebody has written leads to a file; one that is too long, or no path at all, does not."""
    return os.path.isfile(path)  # noqa: PTH113 - pathlib raises for what cannot be a path


def is_folder(path: Path) -> bool:
    """Whether such a path leads to a folder, which one may look into."""
    return os.path.isdir(path)  # noqa: PTH112 - pathlib raises for what cannot be a path


def find_home(start: Path) -> Path:
    """Find the course folder for whoever works in a folder.

    Args:
        start: the folder, absolute.
    """
    beside = PACKAGE.parent if is_course(PACKAGE.parent) else SHIPPED
    return next((folder for folder in (start, *start.parents) if is_course(folder) and is_ours(folder)), beside)


def is_course(folder: Path) -> bool:
    """Whether a folder is a course folder."""
    return all(is_folder(folder / part) for part in COURSE)


def is_ours(folder: Path) -> bool:
    """Whether a folder is no stranger's: what is in a course folder is run."""
    return folder.stat().st_uid in (os.getuid(), ROOT)


HOME = find_home(Path.cwd())
"""The course folder of this process."""


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


def find_model(given: str) -> Path:
    """Find a model: a path, or the name of one of the tutorial's own, such as ``tank``, or as bodies have it, ``Tank``.

    Raises:
        TutorialError: there is no such model; the text names the nearest.
    """
    if given.lower().endswith((".xml", *OTHER_MODELS)) and is_file(Path(given)):
        return Path(given)
    name = given.lower() if given.isidentifier() else given
    return _find(name, HOME / "project" / "models", ".xml", "model")


def with_own_commands(environment: Mapping[str, str]) -> dict[str, str]:
    """Let a process find the commands that are installed beside this Python, such as ``tank``, activated or not."""
    commands = (str(Path(sys.executable).parent), environment.get("PATH", os.defpath))
    return {**environment, "PATH": os.pathsep.join(commands)}


def _find(given: str, folder: Path, suffix: str, what: str) -> Path:
    if is_file(Path(given)):
        if not given.endswith(suffix):
            raise TutorialError(f"{given!r} is no {what}: the name of one ends in {suffix!r}.")
        return Path(given)
    if is_file(folder / f"{given}{suffix}"):
        return folder / f"{given}{suffix}"
    beside = Path(given).parent
    wanted = Path(given).name
    if wanted == given or not is_folder(beside):
        known = [path.name.removesuffix(suffix) for path in folder.glob(f"*{suffix}")]
        wanted = wanted.removesuffix(suffix)
    else:
        known = [path.name for path in beside.glob(f"*{suffix}")]
    raise TutorialError(f"there is no {what} {given!r}.{did_you_mean(wanted, known)}")
