"""Small functions that programs use."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rclpy import _arguments
from rclpy.context import Context

__all__ = [
    "get_default_context",
    "get_rmw_implementation_identifier",
    "ok",
    "remove_ros_args",
]

_default_context: Context | None = Context()


def get_default_context(*, shutting_down: bool = False) -> Context:  # noqa: ARG001  (rclpy's signature)
    """Return the context that is meant when none is given. Takes no lock, because a signal handler calls this."""
    global _default_context  # noqa: PLW0603
    if _default_context is None:
        _default_context = Context()
    return _default_context


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return a command line without what is meant for ROS 2; None takes ``sys.argv``."""
    return _arguments.split(sys.argv if args is None else args)[1]


def ok(*, context: Context | None = None) -> bool:
    """Whether ROS 2 is running."""
    return (context or get_default_context()).ok()


def get_rmw_implementation_identifier() -> str:
    """Return which middleware is used."""
    return "rmw_cyclonedds_underlay"
