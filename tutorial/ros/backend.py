"""Which ROS 2 is in use: a real one if this Python finds it or the user asks for it, else the pocket ROS 2."""

import os
import sys
from collections.abc import Callable
from functools import cache
from importlib.abc import MetaPathFinder
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from typing import Literal

from tutorial.errors import TutorialError, did_you_mean
from tutorial.ros.wheels import folder

Backend = Literal["rclpy", "pocket"]

VARIABLE = "TUTORIAL_ROS"


@cache
def ros_backend() -> Backend:
    """Return which ROS 2 this process uses: ``"rclpy"``, a real one, or ``"pocket"``, that of this package.

    It is decided once, and ``import rclpy`` and the messages work accordingly. A sourced ROS 2 is used if there is one.
    Otherwise ``TUTORIAL_ROS=rclpy`` selects the one in the folder that ``tank ros install`` fills, and without the
    variable the pocket ROS 2 is used. ``TUTORIAL_ROS=pocket`` selects the pocket ROS 2 in any case.

    Raises:
        TutorialError: ``TUTORIAL_ROS`` has another value, or the ROS 2 that was asked for cannot be used.
    """
    return _choose(os.environ.get(VARIABLE, ""))


def use_real_ros() -> None:
    """Use a real ROS 2 in this process and in those that it starts: a sourced one, else that of ``tank ros install``.

    Call it before anything of ROS 2 is imported, in a notebook in its first cell::

        from tutorial import use_real_ros

        use_real_ros()

    Raises:
        TutorialError: the pocket ROS 2 is already in use, or no real ROS 2 can be used; the text says what to do.
    """
    _choose("rclpy")
    os.environ[VARIABLE] = "rclpy"
    ros_backend.cache_clear()


def promise() -> None:
    """Make ``import rclpy`` work, or let it raise an error that says what is wrong.

    ``import tutorial`` itself does not fail: without rclpy, ``tank doctor`` can still find out why there is none.
    """
    try:
        ros_backend()
    except TutorialError:
        sys.meta_path.insert(0, _Guard(_require_backend))


class _Guard(MetaPathFinder):
    """Checks each import.

    Args:
        check: called with the full name of a module. It raises an error if the module must not be imported.
    """

    def __init__(self, check: Callable[[str], None]) -> None:
        self._check = check

    def find_spec(self, fullname: str, _path: object = None, _target: object = None) -> None:
        self._check(fullname)


def _require_backend(module: str) -> None:
    """Raise the error of `ros_backend`, if it still has one, for a module of ROS 2."""
    if module == "rclpy" or module.endswith(("_msgs", "_interfaces")):
        ros_backend()


def _choose(wanted: str) -> Backend:
    """Make the rclpy importable that a value of ``TUTORIAL_ROS`` asks for.

    Raises:
        TutorialError: the value is not valid, or the ROS 2 that it asks for cannot be used.
    """
    if wanted not in ("", "rclpy", "pocket"):
        raise TutorialError(f"{VARIABLE} is {wanted!r}.{did_you_mean(wanted, ('rclpy', 'pocket'))}")
    import pocket_ros2  # noqa: PLC0415  (which makes an rclpy importable)

    if wanted == "pocket":
        pocket_ros2.install(first=True)
        return "pocket"
    sourced = pocket_ros2.real_rclpy()
    if sourced is None and wanted == "":
        return "pocket"
    if sourced is not None:
        _check_version(sourced)
    if sourced is None or sourced.is_relative_to(folder.prefix()):
        folder.check()
    if wanted == "rclpy" and not pocket_ros2.uninstall():
        raise TutorialError(
            "the pocket ROS 2 is in use already. Choose the real one before anything of ROS 2 is imported: "
            "in a notebook, restart the kernel, and run the cell with use_real_ros() first."
        )
    if sourced is None:
        folder.activate()
        sys.meta_path.append(_Guard(folder.explain_missing))  # last: called only if no finder finds a module
    return "rclpy"


def _check_version(rclpy: Path) -> None:
    """Refuse an rclpy, given by its folder, that was compiled for another Python.

    Raises:
        TutorialError: it was compiled for another Python.
    """
    if not any((rclpy / f"_rclpy_pybind11{suffix}").exists() for suffix in EXTENSION_SUFFIXES):
        raise TutorialError(
            f"the ROS 2 in {rclpy} is for another Python than this one, {folder.PYTHON}. "
            f"Open a terminal in which it is not sourced, or type export {VARIABLE}=pocket."
        )
