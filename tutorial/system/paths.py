"""Finds the tutorial's files: projects, launch files, notebooks, drives, models.

A folder that contains these files is a *course folder*. There are three kinds of course folders: a checkout; the folder
in an installed package, which is never written to; and a learner's copy of that folder, made by ``tank lab``. A process
chooses its course folder when it starts: the nearest course folder from the current directory upwards; else the
checkout that contains the package; else the folder in the package.
"""

import os
import sys
from collections.abc import Mapping
from pathlib import Path

from tutorial.errors import TutorialError, did_you_mean

COURSE = ("launch_py", "notebooks", "project")
"""A folder that contains these folders is a course folder."""

ROOT = 0  # the user

OTHER_MODELS = (".urdf", ".mjcf", ".xacro")
"""Suffixes of model files, other than .xml. Reading a xacro file raises an error that explains how to convert it."""

PACKAGE = Path(__file__).resolve().parents[1]
"""The folder of the package ``tutorial``. Its parent folder is on the Python path."""

SHIPPED = PACKAGE / "_files"
"""The course folder in an installed package. A checkout does not have this folder."""


def is_file(path: Path) -> bool:
    """Return whether a path, which may come from a user, is a file; False if the path is too long or malformed."""
    return os.path.isfile(path)  # noqa: PTH113 - pathlib raises an error for an invalid path


def is_folder(path: Path) -> bool:
    """Return whether a path, which may come from a user, is a folder."""
    return os.path.isdir(path)  # noqa: PTH112 - pathlib raises an error for an invalid path


def find_home(start: Path) -> Path:
    """Find the course folder that a process uses if it starts in a given working directory.

    Args:
        start: the absolute path of the working directory.
    """
    return next((folder for folder in (start, *start.parents) if is_course(folder) and is_ours(folder)), original())


def original() -> Path:
    """Return the course folder that came with the package, never a learner's copy."""
    return PACKAGE.parent if is_course(PACKAGE.parent) else SHIPPED


def is_course(folder: Path) -> bool:
    """Return whether a folder is a course folder."""
    return all(is_folder(folder / part) for part in COURSE)


def is_ours(folder: Path) -> bool:
    """Return whether this user or root owns a folder. A course folder's code is run, so its owner must be trusted."""
    return folder.stat().st_uid in (os.getuid(), ROOT)


HOME = find_home(Path.cwd())
"""The course folder that this process uses."""


def find_project(given: str) -> Path:
    """Find a project file by its path, or by the name of a tutorial project, such as ``step3``.

    Raises:
        TutorialError: there is no such project; the error suggests the closest match.
    """
    return _find(given, HOME / "project", ".yaml", "project")


def find_drive(given: str) -> Path:
    """Find a drive file by its path, or by the name of a tutorial drive, such as ``tour``.

    Raises:
        TutorialError: there is no such drive; the error suggests the closest match.
    """
    return _find(given, HOME / "project" / "drives", ".yaml", "drive")


def find_layout(given: str) -> Path:
    """Find a race layout file by its path or, in the `original` course folder, by its name, such as ``bend``.

    Raises:
        TutorialError: there is no such layout; the error suggests the closest match.
    """
    return _find(given, original() / "project" / "race", ".yaml", "layout")


def find_launch_file(given: str) -> Path:
    """Find a launch file by its path, or by the name of a tutorial launch file, such as ``step3``.

    Raises:
        TutorialError: there is no such launch file; the error suggests the closest match.
    """
    return _find(given, HOME / "launch_py", ".launch.py", "launch file")


def find_model(given: str) -> Path:
    """Find a model by its path, or a tutorial model by its name, which may be capitalized: ``tank`` or ``Tank``.

    Raises:
        TutorialError: there is no such model; the error suggests the closest match.
    """
    if given.lower().endswith((".xml", *OTHER_MODELS)) and is_file(Path(given)):
        return Path(given)
    name = given.lower() if given.isidentifier() else given
    return _find(name, HOME / "project" / "models", ".xml", "model")


def with_own_commands(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment whose PATH begins with the folder of this Python's commands, such as ``tank``."""
    commands = (str(Path(sys.executable).parent), environment.get("PATH", os.defpath))
    return {**environment, "PATH": os.pathsep.join(commands)}


def _find(given: str, folder: Path, suffix: str, what: str) -> Path:
    if is_file(Path(given)):
        if not given.endswith(suffix):
            raise TutorialError(f"{given!r} is not a {what}: its name does not end in {suffix!r}.")
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
