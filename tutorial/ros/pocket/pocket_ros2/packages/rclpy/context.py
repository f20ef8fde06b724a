"""A context: one run of ROS 2 in a process, from start to shutdown."""

from __future__ import annotations

import atexit
import os
import sys
import threading
import weakref
from collections.abc import Callable, Sequence
from inspect import ismethod
from typing import TYPE_CHECKING, Self

from rclpy import _domain
from rclpy._arguments import Arguments
from rclpy._graph import Graph
from rclpy._middleware import join
from rclpy._rclpy_pybind11 import RCLError
from rclpy.logging import muting, set_logger_level

if TYPE_CHECKING:
    from rclpy.executors import SingleThreadedExecutor

TIMEOUT = 2.0
"""Maximum time that a shutdown waits for a running callback [s]."""

NOT_VALID = "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."

_contexts: weakref.WeakSet[Context] = weakref.WeakSet()


class Context:
    """The state that nodes and executors share: the arguments and the participant in the DDS domain.

    A context can be started and shut down only once. It can be used from any thread. A ``with`` statement starts it on
    entry and shuts it down on exit.

    Attributes:
        arguments: the ROS arguments that the context was started with.
    """

    def __init__(self) -> None:
        self._ok = self._was_initialized = False
        self._domain_id = 0
        self.arguments = Arguments()
        self._graph: Graph | None = None
        self._callbacks: list[Callable[[], Callable[[], object] | None]] = []
        self._executors: list[weakref.ref[SingleThreadedExecutor]] = []  # replaced, never modified
        _contexts.add(self)

    def init(
        self, args: Sequence[str] | None = None, *, initialize_logging: bool = True, domain_id: int | None = None
    ) -> None:
        """Start the context.

        Args:
            args: the command line; if None, ``sys.argv``.
            initialize_logging: apply the logging options on the command line.
            domain_id: the DDS domain; if None, ``ROS_DOMAIN_ID`` or, if that is not set, 0.

        Raises:
            RuntimeError: the context has already been started, or the domain ID is negative.
            RCLError: an argument or an environment variable is invalid.
        """
        with _domain.lock:
            if domain_id is not None and domain_id < 0:
                raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
            if self._was_initialized:
                raise RuntimeError("Context.init() must only be called once")
            self.arguments = Arguments.parse(sys.argv if args is None else args)
            self.arguments.check_enclave()
            self._domain_id = _domain.default_domain_id() if domain_id is None else domain_id
            if self._domain_id > _domain.MAX_DOMAIN_ID:
                raise RCLError(f"failed to initialize rcl: domain {domain_id} is above {_domain.MAX_DOMAIN_ID}")
            self._ok = self._was_initialized = True
            if initialize_logging:
                self._initialize_logging()

    def _initialize_logging(self) -> None:
        """Apply the logging options on the command line. If that fails, the context stays initialized, as in rclpy."""
        if self.arguments.log_configuration:
            reason = "spdlog logging backend doesn't currently support external configuration"
            raise RCLError(f"failed to initialize logging: {reason}")
        for logger, level in self.arguments.log_levels.items():
            set_logger_level(logger, level)
        if "stdout" in self.arguments.disabled_logs:
            muting.add(self)

    def ok(self) -> bool:
        """Return whether the context has been started and not shut down."""
        return self._ok

    def shutdown(self) -> None:
        """Shut down: stop the context's executors, and remove all nodes from the graph.

        Raises:
            RuntimeError: the context has not been started, or has already been shut down.
        """
        if not self._was_initialized:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        if not self._ok:
            raise RCLError("failed to shutdown: rcl_shutdown already called on the given context")
        self.try_shutdown()

    def try_shutdown(self) -> None:
        """Shut down if the context is running, wait until no other thread is spinning, and call the shutdown callbacks.

        As in rclpy, these callbacks are not called if a signal has already stopped the context.
        """
        if not self._was_initialized:
            return
        was_ok = self._ok
        self.stop()
        muting.discard(self)
        for reference in self._executors:
            if executor := reference():
                executor.wait_until_stopped(TIMEOUT)
        with _domain.lock:
            graph, self._graph = self._graph, None
            if graph:
                graph.participant.leave()
            callbacks, self._callbacks = self._callbacks if was_ok else [], []
        for held in callbacks:
            if callback := held():
                callback()

    def on_shutdown(self, callback: Callable[[], object]) -> None:
        """Call a function on shutdown, or at once if the context has already been shut down.

        A method is called only if its object still exists.

        Raises:
            TypeError: the callback is not callable.
        """
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        with _domain.lock:
            if self._ok or not self._was_initialized:
                self._callbacks.append(weakref.WeakMethod(callback) if ismethod(callback) else lambda: callback)
                return
        callback()

    def stop(self) -> None:
        """Stop the context's executors, but leave slow work to :meth:`try_shutdown`.

        A signal handler can call this method.
        """
        if self._ok:
            self._ok = False
            for reference in self._executors:
                if executor := reference():
                    executor.wake()

    def add_executor(self, executor: SingleThreadedExecutor) -> None:
        """Stop an executor when the context shuts down. The context stores only a weak reference to the executor."""
        with _domain.lock:
            self._executors = [*(other for other in self._executors if other()), weakref.ref(executor)]

    def get_domain_id(self) -> int:
        """Return the ID of the DDS domain.

        Raises:
            RuntimeError: the context has not been started.
        """
        if not self._was_initialized:
            raise RuntimeError("Context must be initialized before it can have a domain id")
        return self._domain_id

    @property
    def graph(self) -> Graph:
        """The node graph and the participant in the DDS domain, which is joined on first use.

        Raises:
            RCLError: the context is not running, or the domain cannot be joined.
        """
        with _domain.lock:
            if not self._ok:
                raise RCLError(NOT_VALID)
            if self._graph is None:
                self._graph = Graph(join(self._domain_id))
            return self._graph

    def __enter__(self) -> Self:
        self.init()
        return self

    def __exit__(self, *_: object) -> None:
        self.try_shutdown()


def stop_all() -> None:
    """Stop all executors in this process; a signal handler can call this function."""
    for context in tuple(_contexts):
        context.stop()


def _forget_all() -> None:
    """End all contexts in a newly forked process, where no thread is spinning."""
    for context in _contexts:
        context._ok, context._graph, context._executors = False, None, []


os.register_at_fork(after_in_child=_forget_all)


@atexit.register
def _shut_down_all() -> None:
    """Leave all domains when the interpreter exits, so that other programs notice the exit at once.

    Threads that are still running are daemon threads, which are about to be stopped. Don't report the errors that
    these threads raise about closed contexts.
    """
    report = threading.excepthook

    def report_others(args: threading.ExceptHookArgs) -> None:
        if not args.exc_type.__module__.startswith("rclpy."):
            report(args)

    threading.excepthook = report_others
    for context in list(_contexts):
        context._callbacks.clear()
        context.try_shutdown()
