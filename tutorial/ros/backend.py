"""Which ROS 2 is in use: the real one if there is one, else the pocket ROS 2."""

from __future__ import annotations

import os
import sys
from functools import cache
from importlib.abc import MetaPathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import Literal, cast

from tutorial.errors import TutorialError, did_you_mean

__all__ = ["install_backend", "promise", "ros_backend"]

Backend = Literal["rclpy", "pocket"]

POCKET = Path(__file__).parent / "pocket"


def ros_backend() -> Backend:
    """Say which ROS 2 this process uses: ``"rclpy"``, a real one, or ``"pocket"``, that of this package."""
    return install_backend()


@cache
def install_backend() -> Backend:
    """Decide once, and make ``import rclpy`` and the messages work accordingly.

    The environment variable ``TUTORIAL_ROS`` decides by hand. Otherwise a real rclpy wins; one that is there but broken
    raises its own error when it is imported, instead of being hidden by the pocket ROS 2.

    Raises:
        TutorialError: ``TUTORIAL_ROS`` names neither.
    """
    wanted = os.environ.get("TUTORIAL_ROS", "")
    if wanted not in ("", "rclpy", "pocket"):
        raise TutorialError(f"TUTORIAL_ROS is {wanted!r}.{did_you_mean(wanted, ('rclpy', 'pocket'))}")
    backend = wanted or ("rclpy" if real_rclpy_exists() else "pocket")
    if backend == "pocket":
        join_pocket(first=wanted == "pocket")
    return cast(Backend, backend)


def promise() -> None:
    """Make ``import rclpy`` work, or say what is wrong.

    A wrong ``TUTORIAL_ROS`` is no error of ``import tutorial``: without rclpy, ``tank doctor`` can still say so.
    """
    try:
        install_backend()
    except TutorialError as error:
        sys.meta_path.insert(0, _Refusal(str(error)))


class _Refusal(MetaPathFinder):
    """Stands where rclpy would be found, and says why there is none."""

    def __init__(self, reason: str) -> None:
        self._reason = reason

    def find_spec(self, fullname: str, _path: object = None, _target: object = None) -> None:
        if fullname == "rclpy" or fullname.endswith(("_msgs", "_interfaces")):
            raise TutorialError(self._reason)


def real_rclpy_exists() -> bool:
    """Whether an rclpy other than ours can be found; it is not imported."""
    spec = find_spec("rclpy")
    return spec is not None and not (spec.origin and Path(spec.origin).is_relative_to(POCKET))


def join_pocket(*, first: bool) -> None:
    """Put the pocket ROS 2 on the import path.

    Args:
        first: before anything installed, because the user asked for it; else behind, so that real packages win.
    """
    if str(POCKET) not in sys.path:
        sys.path.insert(0 if first else len(sys.path), str(POCKET))
    from _rosidl import finder  # noqa: PLC0415  (importable only now)

    finder.install(first=first)
