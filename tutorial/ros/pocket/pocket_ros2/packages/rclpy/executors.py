"""Executors, which wait for messages and timers, and run callbacks on the thread that spins."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, Self

from rclpy._domain import lock
from rclpy._endpoint import Endpoint
from rclpy._middleware import TransportError
from rclpy._rclpy_pybind11 import RCLError
from rclpy.context import NOT_VALID
from rclpy.subscription import Subscription
from rclpy.timer import Timer
from rclpy.utilities import get_default_context

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.guard_condition import GuardCondition as NodeGuardCondition
    from rclpy.node import Node
    from rclpy.task import Future

LONGEST_WAIT = 0.1
"""Maximum time for one wait within the middleware [s]: Python handles Ctrl-C only between calls into C."""

FEW = 6
"""For up to this many endpoints, polling each one is faster than asking the middleware which ones have messages."""


class ExternalShutdownException(Exception):  # noqa: N818  (rclpy's name)
    """The context was shut down while an executor was spinning."""


class SingleThreadedExecutor:
    """Runs callbacks one at a time, on the thread that calls a ``spin`` method.

    All methods that do not spin can be called from any thread.

    Args:
        context: the executor's context; if None, the default context.

    Raises:
        RCLError: the context is not running.
    """

    def __init__(self, *, context: Context | None = None) -> None:
        self._context = context or get_default_context()
        with lock:  # prevents a shutdown in the meantime
            self._waiter = self._context.graph.participant.create_waiter()
        self._nodes: tuple[Node, ...] = ()
        self._timers: list[Timer] = []
        self._guards: list[NodeGuardCondition] = []
        self._endpoints: list[Endpoint] = []
        self._subscriptions: list[Subscription] = []
        self._ready: Iterator[Subscription | Timer | NodeGuardCondition] = iter(())
        self._outdated = True
        self._is_shutdown = False
        self._spinning = threading.Lock()
        self._spinner: int | None = None
        self._lock = threading.Lock()
        self._context.add_executor(self)

    @property
    def context(self) -> Context:
        """The executor's context."""
        return self._context

    def add_node(self, node: Node) -> bool:
        """Add a node whose callbacks the executor is to run; return False if the node has already been added."""
        with self._lock:
            if node in self._nodes:
                return False
            self._nodes = (*self._nodes, node)
        node.executor = self
        self.wake()
        return True

    def remove_node(self, node: Node) -> None:
        """Stop running a node's callbacks."""
        with self._lock:
            self._nodes = tuple(other for other in self._nodes if other is not node)
        self.wake()

    def get_nodes(self) -> list[Node]:
        """Return the nodes whose callbacks the executor runs."""
        return list(self._nodes)

    def wake(self) -> None:
        """Wake the executor so that it notices a change or stops."""
        self._outdated = True
        with suppress(TransportError):  # the context may be closing
            self._waiter.wake()

    def spin(self) -> None:
        """Run callbacks until the executor is shut down.

        Raises:
            ExternalShutdownException: the context was shut down, but the executor was not.
        """
        self._spin()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run one callback, waiting for one if necessary.

        Args:
            timeout_sec: how long to wait [s]; forever if None or negative.

        Raises:
            ExternalShutdownException: the context was shut down during the wait.
            RCLError: the context had already been shut down.
        """
        self._spin(_deadline(timeout_sec), once=True)

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run callbacks until a future is done or cancelled, or until the timeout expires.

        Args:
            future: the future.
            timeout_sec: how long to wait [s]; forever if None or negative.
        """
        with future._telling(lambda _: self.wake()):
            self._spin(_deadline(timeout_sec), until=lambda: future.done() or future.cancelled())

    def shutdown(self, timeout_sec: float | None = None) -> bool:  # noqa: ARG002  (rclpy does not wait, either)
        """Stop spinning and release the nodes. Idempotent.

        This method does not wait for a callback that is running on another thread.
        """
        self._is_shutdown = True
        self._nodes = ()
        self.wake()
        self._close_if_shut_down()
        return True

    def wait_until_stopped(self, timeout_sec: float) -> None:
        """Wait until no other thread is spinning, but no longer than the timeout [s]."""
        if self._spinner != threading.get_ident() and self._spinning.acquire(timeout=timeout_sec):
            self._spinning.release()

    def _spin(self, deadline: float = math.inf, until: Callable[[], bool] = lambda: False, once: bool = False) -> None:
        """Run callbacks, or just one, until a deadline [s, monotonic clock]. Only one caller can spin at a time."""
        if not self._spinning.acquire(blocking=False):
            raise RuntimeError("Executor is already spinning")
        self._spinner = threading.get_ident()
        try:
            if once and not self._context.ok() and not self._is_shutdown:
                raise RCLError(f"failed to initialize wait set: {NOT_VALID}")
            while self._context.ok() and not self._is_shutdown and not until():
                self._run_one(deadline, until)
                if once or time.monotonic() >= deadline:
                    return
        finally:
            self._spinner = None
            self._spinning.release()
            self._close_if_shut_down()

    def _run_one(self, deadline: float, until: Callable[[], bool]) -> None:
        """Run one callback; if none is ready, wait for one until a deadline [s, monotonic clock]."""
        while not self._is_shutdown and not until():
            if not self._context.ok():
                raise ExternalShutdownException
            if self._run_ready():
                return
            if self._outdated:
                self._look_around()
            if len(self._endpoints) <= FEW:
                self._ready = iter((*self._timers, *self._guards, *self._subscriptions))
                if self._run_ready():
                    return
            left = deadline - time.monotonic()
            self._wait(min(left, LONGEST_WAIT))
            if left <= 0:
                self._run_ready()
                return

    def _run_ready(self) -> bool:
        """Execute the first entity of this round that is ready; return False if no entity is ready."""
        for entity in self._ready:  # noqa: SIM110  (a generator for each round would cost more than the round)
            if entity._node in self._nodes and entity.execute():
                return True
        return False

    def _wait(self, timeout: float) -> None:
        """Wait for a message, an event, a timer or a call to :meth:`wake`, and start a round of callbacks.

        In each round, every ready entity gets one turn, so that a busy topic does not delay the other entities.
        The round includes only the subscriptions that have messages, because checking all of them would slow down a
        node with a hundred subscriptions.
        """
        waits = [timer.wait_time() for timer in self._timers] + [guard.wait_time() for guard in self._guards]
        timeout = max(0.0, min([timeout, *waits]))
        try:
            woken_by = self._waiter.wait(timeout)
        except TransportError:
            if self._context.ok() and not self._is_shutdown:
                raise
            woken_by = []
        self._ready = iter((*self._timers, *self._guards, *filter(None, woken_by)))
        if None in woken_by:
            self._report_events()

    def _report_events(self) -> None:
        with suppress(TransportError, RCLError):  # the context is shutting down
            self._context.graph.listen()
        for endpoint in self._endpoints:
            endpoint.report_events()

    def _look_around(self) -> None:
        """Collect the nodes' entities, and include them in all later waits."""
        self._outdated = False
        self._timers = [timer for node in self._nodes for timer in node.timers]
        self._guards = [guard for node in self._nodes for guard in node.guards]
        self._endpoints = [endpoint for node in self._nodes for endpoint in (*node.publishers, *node.subscriptions)]
        self._subscriptions = [endpoint for endpoint in self._endpoints if isinstance(endpoint, Subscription)]
        with lock:  # prevents a shutdown in the meantime
            if self._context.ok():
                watched = [(endpoint._wire, endpoint) for endpoint in self._endpoints]
                self._waiter.watch([(self._context.graph.changes, None), *watched])

    def _close_if_shut_down(self) -> None:
        """Release everything if the executor has been shut down and no thread is spinning; otherwise do nothing."""
        if not self._is_shutdown or not self._spinning.acquire(blocking=False):
            return
        self._ready = iter(())
        self._timers, self._guards, self._endpoints, self._subscriptions = [], [], [], []
        self._waiter.close()
        self._spinning.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()


Executor = SingleThreadedExecutor


def _deadline(timeout_sec: float | None) -> float:
    return math.inf if timeout_sec is None or timeout_sec < 0 else time.monotonic() + timeout_sec
