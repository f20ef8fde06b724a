"""The pocket ROS 2: ``rclpy``, ``launch`` and the messages of ROS 2 Jazzy for machines without ROS 2.

``import pocket_ros2`` makes these packages importable. If a real ``rclpy`` is installed, it takes precedence.
"""

from __future__ import annotations

import sys
from importlib.machinery import PathFinder
from pathlib import Path

__all__ = ["PATH", "install", "real_rclpy", "uninstall"]

PATH = Path(__file__).parent / "packages"
"""The folder to add to Python's path. Until it is added, its packages cannot be imported, and do not hide real ones."""


def install(*, first: bool = False) -> bool:
    """Make rclpy, launch and the message packages importable if no real rclpy is installed.

    A broken installation of the real rclpy is not hidden: ``import rclpy`` raises its own error.

    Args:
        first: hide the real rclpy, if it is installed. To hide it, call this function before you import anything from
            ROS 2.

    Returns:
        Whether the pocket ROS 2 is in use.
    """
    if not first and real_rclpy() is not None:
        return False
    if first or str(PATH) not in sys.path:
        sys.path.insert(0 if first else len(sys.path), str(PATH))
    import _absent  # noqa: PLC0415  (importable only now, like the next import)
    from _rosidl import finder  # noqa: PLC0415

    finder.install()
    _absent.install()
    return True


def uninstall() -> bool:
    """Undo `install`, so that the real rclpy can be imported instead.

    Returns:
        Whether `install` was undone. If a part of the pocket ROS 2 has already been imported, nothing changes.
    """
    if "_rosidl.message" in sys.modules:  # the pocket rclpy also imports this module
        return False
    sys.path[:] = [entry for entry in sys.path if entry != str(PATH)]
    ours = ("_absent", "_rosidl.finder")
    sys.meta_path[:] = [finder for finder in sys.meta_path if type(finder).__module__ not in ours]
    return True


def real_rclpy() -> Path | None:
    """Return the folder of the real rclpy without importing it, or None if it is not installed."""
    spec = PathFinder.find_spec("rclpy", [entry for entry in sys.path if entry != str(PATH)])
    return None if spec is None or spec.origin is None else Path(spec.origin).parent


install()
