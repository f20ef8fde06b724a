"""The pocket ROS 2: ``rclpy``, ``launch`` and the messages of ROS 2 Jazzy where no ROS 2 is installed.

``import pocket_ros2`` makes them importable, unless there is a real ``rclpy``, which always wins.
"""

from __future__ import annotations

import sys
from importlib.util import find_spec
from pathlib import Path

__all__ = ["PATH", "install"]

PATH = Path(__file__).parent / "packages"
"""The folder that joins Python's path. Its packages are importable by no other way, so none hides a real one."""


def install(*, first: bool = False) -> bool:
    """Make ``import rclpy``, ``import launch`` and the messages work where there is no real rclpy.

    One that is there but broken raises its own error when it is imported, instead of being hidden.

    Args:
        first: also where there is a real one, which is hidden then. Call it before anything of ROS 2 is imported.

    Returns:
        Whether the pocket ROS 2 is in use.
    """
    if not first and real_rclpy_exists():
        return False
    if first or str(PATH) not in sys.path:
        sys.path.insert(0 if first else len(sys.path), str(PATH))
    from _rosidl import finder  # noqa: PLC0415  (importable only now)

    finder.install()
    return True


def real_rclpy_exists() -> bool:
    """Whether an rclpy other than this one can be found; it is not imported."""
    spec = find_spec("rclpy")
    return spec is not None and spec.origin is not None and not Path(spec.origin).is_relative_to(PATH)


install()
