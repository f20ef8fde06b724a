"""Choose which ROS 2 to use: a real ROS 2 if Python finds one or the user requests one, otherwise the pocket ROS 2."""

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
    """Return which ROS 2 this process uses: ``"rclpy"`` (a real ROS 2) or ``"pocket"`` (the pocket ROS 2).

    The first call makes the choice, and makes rclpy and the message packages importable. ``TUTORIAL_ROS=pocket`` always
    selects the pocket ROS 2. Otherwise, a sourced ROS 2 is used. Without one, ``TUTORIAL_ROS=rclpy`` selects the ROS 2
    installed by ``tank ros install``; if the variable is unset, the pocket ROS 2 is used.

    Raises:
        TutorialError: ``TUTORIAL_ROS`` has an invalid value, or the requested ROS 2 cannot be used.
    """
    return _choose(os.environ.get(VARIABLE, ""))


def use_real_ros() -> None:
    """Use a real ROS 2 in this process and its children: a sourced one, or the one that ``tank ros install`` installed.

    Call this function before importing anything from ROS 2; in a notebook, call it in the first cell::

        from tutorial import use_real_ros

        use_real_ros()

    Raises:
        TutorialError: the pocket ROS 2 is already in use, or no real ROS 2 can be used; the error says what to do.
    """
    _choose("rclpy")
    os.environ[VARIABLE] = "rclpy"
    ros_backend.cache_clear()


def real_ros_needed(what: str) -> TutorialError:
    """Return an error that says what needs a real ROS 2, and explains how to install and use one.

    Args:
        what: what needs a real ROS 2, such as ``"TankServer"``; the subject of the error's first sentence.
    """
    get = "" if folder.state() == "installed" else f" {folder.how_to_get_it()}"
    use = f"To use it, run export {VARIABLE}=rclpy or, in a notebook, use_real_ros()."
    return TutorialError(f"{what} needs a real ROS 2, because the pocket one has only topics.{get} {use}")


def need_real_ros(what: str) -> None:
    """If this process uses the pocket ROS 2, raise the error that `real_ros_needed` returns.

    Raises:
        TutorialError: this process uses the pocket ROS 2.
    """
    if ros_backend() == "pocket":
        raise real_ros_needed(what)


def promise() -> None:
    """Make ``import rclpy`` work, or make it raise an error that explains the problem.

    ``import tutorial`` itself does not fail, so ``tank doctor`` can run without rclpy and find out why it is missing.
    """
    try:
        ros_backend()
    except TutorialError:
        sys.meta_path.insert(0, _Guard(_require_backend))


class _Guard(MetaPathFinder):
    """Import hook that checks each module.

    Args:
        check: called with a module's full name; raises an error if the module must not be imported.
    """

    def __init__(self, check: Callable[[str], None]) -> None:
        self._check = check

    def find_spec(self, fullname: str, _path: object = None, _target: object = None) -> None:
        self._check(fullname)


def _require_backend(module: str) -> None:
    """For ROS 2 modules, call `ros_backend` again: if it still fails, the import raises its error."""
    if module == "rclpy" or module.endswith(("_msgs", "_interfaces")):
        ros_backend()


def _choose(wanted: str) -> Backend:
    """Select an rclpy according to the value of ``TUTORIAL_ROS``, and make it importable.

    Raises:
        TutorialError: the value is invalid, or the selected ROS 2 cannot be used.
    """
    if wanted not in ("", "rclpy", "pocket"):
        raise TutorialError(f"{VARIABLE} is {wanted!r}.{did_you_mean(wanted, ('rclpy', 'pocket'))}")
    import pocket_ros2  # noqa: PLC0415  (importing it makes rclpy importable)

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
            "the pocket ROS 2 is already in use. Choose the real one before importing anything from ROS 2: "
            "in a notebook, restart the kernel, and start with the cell that calls use_real_ros()."
        )
    if sourced is None:
        folder.activate()
        sys.meta_path.append(_Guard(folder.explain_missing))  # last, to see only modules that no other finder finds
    return "rclpy"


def _check_version(rclpy: Path) -> None:
    """Reject the rclpy in a folder if it was compiled for a different Python version.

    Raises:
        TutorialError: the rclpy was compiled for a different version.
    """
    if not any((rclpy / f"_rclpy_pybind11{suffix}").exists() for suffix in EXTENSION_SUFFIXES):
        raise TutorialError(
            f"the ROS 2 in {rclpy} is for a different Python version than this one, {folder.PYTHON}. "
            f"Open a terminal where it is not sourced, or run export {VARIABLE}=pocket."
        )
