"""Small functions that programs use."""

import sys
import threading
from collections.abc import Sequence

from rclpy import _arguments
from rclpy.constants import S_TO_NS as S_TO_NS  # noqa: PLC0414  (programs find it here, too)
from rclpy.context import Context

_default_context: Context | None = None
_lock = threading.RLock()  # the main thread may hold it when a signal handler asks on the same thread


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the context that is meant when none is given.

    Args:
        shutting_down: the next call is to return a new one.
    """
    global _default_context  # noqa: PLW0603
    with _lock:
        context = _default_context or Context()
        _default_context = None if shutting_down else context
        return context


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return a command line without what is meant for ROS 2; None takes ``sys.argv``."""
    return _arguments.split(sys.argv if args is None else args)[1]


def ok(*, context: Context | None = None) -> bool:
    """Whether ROS 2 is running."""
    return (context or get_default_context()).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Shut a context down; None takes the default one, in whose place comes a new one.

    Raises:
        RuntimeError: it has not been started, or has been shut down.
    """
    (context or get_default_context(shutting_down=True)).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut a context down if it is running; None takes the default one, in whose place comes a new one."""
    (context or get_default_context(shutting_down=True)).try_shutdown()


def get_rmw_implementation_identifier() -> str:
    """Return which middleware is used."""
    return "rmw_cyclonedds_pocket"
