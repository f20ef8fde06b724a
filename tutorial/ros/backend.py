"""Which ROS 2 is in use: a real one if this Python finds it or the user asks for it, else the pocket ROS 2."""

import os
import re
import sys
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
    wanted = os.environ.get(VARIABLE, "")
    if wanted not in ("", "rclpy", "pocket"):
        raise TutorialError(f"{VARIABLE} is {wanted!r}.{did_you_mean(wanted, ('rclpy', 'pocket'))}")
    import pocket_ros2  # noqa: PLC0415  (which makes an rclpy importable)

    if wanted == "pocket":
        pocket_ros2.install(first=True)
        return "pocket"
    sourced = pocket_ros2.real_rclpy()
    if sourced is not None:
        _check_version(sourced)
    elif wanted == "":
        return "pocket"
    if sourced is None or folder.has(sourced):
        folder.check()
    if wanted == "rclpy" and not pocket_ros2.uninstall():
        raise TutorialError(
            "the pocket ROS 2 is in use already. Choose the real one before anything of ROS 2 is imported: "
            "in a notebook, restart the kernel, and run the cell with use_real_ros() first."
        )
    if sourced is None:
        folder.activate()
        for reason, names in folder.MISSING.items():
            sys.meta_path.append(_Refusal(reason, *names))  # last: called only if no finder finds a module
    return "rclpy"


def use_real_ros() -> None:
    """Use a real ROS 2 in this process and in those that it starts: a sourced one, else that of ``tank ros install``.

    Call it before anything of ROS 2 is imported, in a notebook in its first cell::

        from tutorial import use_real_ros

        use_real_ros()

    Raises:
        TutorialError: the pocket ROS 2 is already in use, or no real ROS 2 can be used; the text says what to do.
    """
    before = os.environ.get(VARIABLE)
    refusals = [finder for finder in sys.meta_path if isinstance(finder, _Refusal) and finder.refuses("rclpy")]
    os.environ[VARIABLE] = "rclpy"
    ros_backend.cache_clear()
    try:
        ros_backend()
        sys.meta_path[:] = [finder for finder in sys.meta_path if finder not in refusals]
    except TutorialError:
        os.environ.pop(VARIABLE)
        if before is not None:
            os.environ[VARIABLE] = before
        raise


def promise() -> None:
    """Make ``import rclpy`` work, or let it raise an error that says what is wrong.

    ``import tutorial`` itself does not fail: without rclpy, ``tank doctor`` can still find out why there is none.
    """
    try:
        ros_backend()
    except TutorialError as error:
        sys.meta_path.insert(0, _Refusal(str(error), "rclpy", "_msgs", "_interfaces"))


class _Refusal(MetaPathFinder):
    """Raises an error when certain packages are imported.

    Args:
        reason: the error's text.
        names: the packages' names; one that begins with an underscore stands for all that end like this.
    """

    def __init__(self, reason: str, *names: str) -> None:
        self._reason, self._names = reason, names
        self._endings = tuple(name for name in names if name.startswith("_"))

    def refuses(self, name: str) -> bool:
        return name in self._names or name.endswith(self._endings)

    def find_spec(self, fullname: str, _path: object = None, _target: object = None) -> None:
        if self.refuses(fullname):
            raise TutorialError(self._reason)


def _check_version(rclpy: Path) -> None:
    """Refuse an rclpy, given by its folder, that was compiled for another Python.

    Raises:
        TutorialError: it was compiled for another Python.
    """
    if any((rclpy / f"_rclpy_pybind11{suffix}").exists() for suffix in EXTENSION_SUFFIXES):
        return
    version = re.search(r"python(3\.\d+)", str(rclpy))
    theirs = f"Python {version[1]}" if version else "another Python"
    ours = f"Python {sys.version_info.major}.{sys.version_info.minor}"
    raise TutorialError(
        f"the ROS 2 in {rclpy} is for {theirs}, and this is {ours}. "
        f"Open a terminal in which it is not sourced, or type export {VARIABLE}=pocket."
    )
