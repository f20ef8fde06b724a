"""The pocket ROS 2: the part of rclpy that the tutorial teaches, with the API of ROS 2 Jazzy, built on Cyclone DDS.

It can communicate with programs that use a real ROS 2, because the topic names, the types, the quality of service and
the node graph are the same. Any use of a missing part raises ``rclpy.exceptions.NeedsRealROSError``.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import _absent as _absent_packages
from _rosidl import finder

finder.install()
_absent_packages.install()

from rclpy import _absent, logging, utilities  # noqa: E402, F401
from rclpy._domain import lock as _lock  # noqa: E402
from rclpy.context import Context  # noqa: E402
from rclpy.executors import Executor, SingleThreadedExecutor  # noqa: E402
from rclpy.node import Node  # noqa: E402
from rclpy.parameter import Parameter  # noqa: E402, F401
from rclpy.signals import SignalHandlerOptions, install_signal_handlers, uninstall_signal_handlers  # noqa: E402
from rclpy.task import Future  # noqa: E402
from rclpy.utilities import get_default_context, get_rmw_implementation_identifier, ok  # noqa: E402, F401

_absent.install()

_executor: SingleThreadedExecutor | None = None


def init(
    *,
    args: Sequence[str] | None = None,
    context: Context | None = None,
    domain_id: int | None = None,
    signal_handler_options: SignalHandlerOptions | None = None,
) -> None:
    """Start ROS 2.

    Args:
        args: the command line; None means ``sys.argv``.
        context: the context to start; None means the default context.
        domain_id: the DDS domain; by default, the value of ``ROS_DOMAIN_ID``, or 0 if the variable is not set.
        signal_handler_options: the signals that shut ROS 2 down; None means all of them for the default context, and
            no signals for any other context.

    Raises:
        RuntimeError: the context has already been started.
    """
    default = context is None or context is get_default_context()
    (context or get_default_context()).init(args, domain_id=domain_id)
    if signal_handler_options is None:
        signal_handler_options = SignalHandlerOptions.ALL if default else SignalHandlerOptions.NO
    install_signal_handlers(signal_handler_options)


def get_global_executor() -> Executor:
    """Return the global executor."""
    global _executor  # noqa: PLW0603
    with _lock:
        if _executor is None:
            _executor = SingleThreadedExecutor()
        return _executor


def shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut ROS 2 down.

    Args:
        context: the context to shut down; None means the default context.
        uninstall_handlers: restore the previous signal handlers; None means only if the context is the default context.

    Raises:
        RuntimeError: the context has not been started, or has been shut down.
    """
    _end(utilities.shutdown, context, uninstall_handlers)


def try_shutdown(*, context: Context | None = None, uninstall_handlers: bool | None = None) -> None:
    """Shut ROS 2 down if it is running; see :func:`shutdown`."""
    _end(utilities.try_shutdown, context, uninstall_handlers)


def create_node(node_name: str, **options: Any) -> Node:
    """Create a node; see :class:`rclpy.node.Node`."""
    return Node(node_name, **options)


def spin(node: Node, executor: Executor | None = None) -> None:
    """Run a node's callbacks until ROS 2 is shut down.

    Args:
        node: the node.
        executor: the executor to use; None means the global executor.
    """
    with _running(node, executor) as running:
        running.spin()


def spin_once(node: Node, *, executor: Executor | None = None, timeout_sec: float | None = None) -> None:
    """Run one of a node's callbacks; if none is ready, wait for one.

    Args:
        node: the node.
        executor: the executor to use; None means the global executor.
        timeout_sec: how long to wait [s]; None or a negative number to wait forever.
    """
    with _running(node, executor) as running:
        running.spin_once(timeout_sec=timeout_sec)


def spin_until_future_complete(
    node: Node, future: Future, executor: Executor | None = None, timeout_sec: float | None = None
) -> None:
    """Run a node's callbacks until a future is done or time runs out.

    Args:
        node: the node.
        future: the future.
        executor: the executor to use; None means the global executor.
        timeout_sec: how long to wait [s]; None or a negative number to wait forever.
    """
    with _running(node, executor) as running:
        running.spin_until_future_complete(future, timeout_sec)


@contextmanager
def _running(node: Node, executor: Executor | None) -> Iterator[Executor]:
    executor = executor or get_global_executor()
    try:
        executor.add_node(node)
        yield executor
    finally:
        executor.remove_node(node)


def _end(shut_down: Any, context: Context | None, uninstall_handlers: bool | None) -> None:
    """Shut down the global executor, then the context. If a callback calls this function, don't wait for it to end."""
    global _executor  # noqa: PLW0603
    default = context is None or context is get_default_context()
    with _lock:
        if _executor is not None and _executor.context is (context or get_default_context()):
            _executor.shutdown()
            _executor = None
    shut_down(context=context)
    if uninstall_handlers or (uninstall_handlers is None and default):
        uninstall_signal_handlers()
