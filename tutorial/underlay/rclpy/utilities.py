"""Small functions that programs use."""

from __future__ import annotations

import sys
import threading
from collections.abc import Sequence

from rclpy import _arguments
from rclpy.context import Context
from rclpy.duration import S_TO_NS

__all__ = [
    "get_default_context",
    "get_rmw_implementation_identifier",
    "ok",
    "remove_ros_args",
    "shutdown",
    "timeout_sec_to_nsec",
    "try_shutdown",
]

_default_context: Context | None = None
_lock = threading.Lock()


def get_default_context(*, shutting_down: bool = False) -> Context:  # noqa: ARG001  (rclpy's signature)
    """Return the context that is meant when none is given."""
    global _default_context  # noqa: PLW0603
    with _lock:
        if _default_context is None:
            _default_context = Context()
        return _default_context


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return a command line without what is meant for ROS 2; None takes ``sys.argv``."""
    return _arguments.split(sys.argv if args is None else args)[1]


def ok(*, context: Context | None = None) -> bool:
    """Whether ROS 2 is running."""
    return (context or get_default_context()).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Shut a context down; RuntimeError if it is not running."""
    (context or get_default_context()).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut a context down if it is running."""
    (context or get_default_context()).try_shutdown()


def get_rmw_implementation_identifier() -> str:
    """Return which middleware is used."""
    return "rmw_cyclonedds_underlay"


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Convert a timeout [s] to [ns], -1 for none."""
    return -1 if timeout_sec is None or timeout_sec < 0 else int(timeout_sec * S_TO_NS)
