"""Utilities for programs."""

import sys
import threading
from collections.abc import Sequence

from rclpy import _arguments
from rclpy.constants import S_TO_NS as S_TO_NS  # noqa: PLC0414  (re-export)
from rclpy.context import Context

_default_context: Context | None = None
_lock = threading.RLock()  # reentrant, because a signal handler can run on the thread that holds the lock


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the default context.

    Args:
        shutting_down: make the next call return a new context.
    """
    global _default_context  # noqa: PLW0603
    with _lock:
        context = _default_context or Context()
        _default_context = None if shutting_down else context
        return context


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return a command line, by default ``sys.argv``, without its ROS arguments."""
    return _arguments.split(sys.argv if args is None else args)[1]


def ok(*, context: Context | None = None) -> bool:
    """Return whether ROS 2 is running."""
    return (context or get_default_context()).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Shut down a context; if None, shut down the default context and replace it with a new one.

    Raises:
        RuntimeError: the context has not been started, or has already been shut down.
    """
    (context or get_default_context(shutting_down=True)).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut down a context like :func:`shutdown`, but raise no error if the context is not running."""
    (context or get_default_context(shutting_down=True)).try_shutdown()


def get_rmw_implementation_identifier() -> str:
    """Return the name of the middleware."""
    return "rmw_cyclonedds_pocket"
