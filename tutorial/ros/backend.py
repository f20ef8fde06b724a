"""Which ROS 2 is in use: the real one if there is one, else the pocket ROS 2."""

import os
import sys
from functools import cache
from importlib.abc import MetaPathFinder
from typing import Literal

from tutorial.errors import TutorialError, did_you_mean

Backend = Literal["rclpy", "pocket"]


@cache
def ros_backend() -> Backend:
    """Say which ROS 2 this process uses: ``"rclpy"``, a real one, or ``"pocket"``, that of this package.

    It is decided once, and ``import rclpy`` and the messages work accordingly. The environment variable
    ``TUTORIAL_ROS`` decides by hand. Otherwise a real rclpy wins.

    Raises:
        TutorialError: ``TUTORIAL_ROS`` names neither.
    """
    wanted = os.environ.get("TUTORIAL_ROS", "")
    if wanted not in ("", "rclpy", "pocket"):
        raise TutorialError(f"TUTORIAL_ROS is {wanted!r}.{did_you_mean(wanted, ('rclpy', 'pocket'))}")
    if wanted == "rclpy":
        return "rclpy"
    import pocket_ros2  # noqa: PLC0415  (which makes an rclpy importable)

    return "pocket" if pocket_ros2.install(first=wanted == "pocket") else "rclpy"


def promise() -> None:
    """Make ``import rclpy`` work, or say what is wrong.

    A wrong ``TUTORIAL_ROS`` is no error of ``import tutorial``: without rclpy, ``tank doctor`` can still say so.
    """
    try:
        ros_backend()
    except TutorialError as error:
        sys.meta_path.insert(0, _Refusal(str(error)))


class _Refusal(MetaPathFinder):
    """Stands where rclpy would be found, and says why there is none."""

    def __init__(self, reason: str) -> None:
        self._reason = reason

    def find_spec(self, fullname: str, _path: object = None, _target: object = None) -> None:
        if fullname == "rclpy" or fullname.endswith(("_msgs", "_interfaces")):
            raise TutorialError(self._reason)
