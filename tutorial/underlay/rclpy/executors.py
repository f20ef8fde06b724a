"""Executors: they wait for messages and timers, and run the callbacks on the thread that spins."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, Self

from cyclonedds.core import DDSException, GuardCondition, WaitSet
from rclpy._domain import close, lock
from rclpy._rclpy_pybind11 import RCLError
from rclpy.exceptions import NeedsRealROSError
from rclpy.subscription import Subscription
from rclpy.timer import Timer
from rclpy.utilities import get_default_context

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.node import Node
    from rclpy.task import Future

__all__ = ["Executor", "ExternalShutdownException", "SingleThreadedExecutor"]

LONGEST_WAIT = 0.1
"""How long to wait at most within Cyclone DDS [s]: Python hears a Ctrl-C only between calls into C."""


class ExternalShutdownException(Exception):  # noqa: N818  (rclpy's name)
    """The context was shut down while an executor was spinning."""


class SingleThreadedExecutor:
    """Runs callbacks one after the other, on the thread that calls a ``spin`` method.

    Everything but these methods may be used from any thread.

    Args:
        context: None takes the default one.

    Raises:
        RCLError: the context is not running.
    """

    def __init__(self, *, context: Context | None = None) -> None:
        self._context = context or get_default_context()
        with lock:
            self._guard = GuardCondition(self._context.participant)
        self._wait_set: WaitSet | None = None
        self._nodes: tuple[Node, ...] = ()
        self._timers: tuple[Timer, ...] = ()
        self._subscriptions: tuple[Subscription, ...] = ()
        self._ready: deque[Subscription | Timer] = deque()
        self._outdated = True
        self._is_shutdown = False
        self._spinning = threading.Lock()
        self._lock = threading.Lock()
        self._context.add_executor(self)

    @property
    def context(self) -> Context:
        """The context that it belongs to."""
        return self._context

    def add_node(self, node: Node) -> bool:
        """Run this node's callbacks, too; False if it does already."""
        with self._lock:
            if node in self._nodes:
                return False
            self._nodes = (*self._nodes, node)
        node.executor = self
        self.wake()
        return True

    def remove_node(self, node: Node) -> None:
        """No longer run this node's callbacks."""
        with self._lock:
            self._nodes = tuple(other for other in self._nodes if other is not node)
        self.wake()

    def get_nodes(self) -> list[Node]:
        """Return the nodes whose callbacks it runs."""
        return list(self._nodes)

    def wake(self) -> None:
        """Make it look around: something was added or removed, or it is to stop."""
        self._outdated = True
        with suppress(DDSException):  # the context may be closing at this moment
            self._guard.set(True)

    def spin(self) -> None:
        """Run callbacks until the executor is shut down.

        Raises:
            ExternalShutdownException: the context was shut down instead.
        """
        with self._spin():
            while self._context.ok() and not self._is_shutdown:
                self._run_one(None)

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait for one callback to run, and run it.

        Args:
            timeout_sec: how long to wait [s]; None or negative: without end.

        Raises:
            ExternalShutdownException: the context was shut down.
        """
        with self._spin():
            self._run_one(timeout_sec)

    def spin_until_future_complete(self, future: Future, timeout_sec: float | None = None) -> None:
        """Run callbacks until a future is done or time runs out.

        Args:
            future: which one.
            timeout_sec: how long to wait [s]; None or negative: without end.
        """
        future.add_done_callback(lambda _: self.wake())
        deadline = _deadline(timeout_sec)
        with self._spin():
            while self._context.ok() and not self._is_shutdown and not future.done() and _left(deadline) > 0:
                self._run_one(None if deadline is None else _left(deadline), until=future.done)

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop spinning and give the nodes up; may be called again.

        Args:
            timeout_sec: how long to wait for a callback that is running [s]; None or negative: without end.

        Returns:
            Whether no callback is running any more.
        """
        self._is_shutdown = True
        self.wake()
        if not self.wait_until_stopped(timeout_sec):
            return False
        self._nodes = ()
        self._ready.clear()
        self._close_wait_set()
        close(self._guard)
        return True

    def wait_until_stopped(self, timeout_sec: float | None) -> bool:
        """Wait until no thread spins, unless this is the one; False if time runs out."""
        if getattr(self, "_spinner", None) == threading.get_ident():
            return True
        if not self._spinning.acquire(timeout=-1 if timeout_sec is None or timeout_sec < 0 else timeout_sec):
            return False
        self._spinning.release()
        return True

    @contextmanager
    def _spin(self) -> Iterator[None]:
        """Hold the right to spin, which only one caller at a time can have."""
        if not self._spinning.acquire(blocking=False):
            raise RuntimeError("Executor is already spinning")
        self._spinner: int | None = threading.get_ident()
        try:
            yield
        finally:
            self._spinner = None
            self._spinning.release()

    def _run_one(self, timeout_sec: float | None, until: Callable[[], bool] = lambda: False) -> None:
        """Run one callback, waiting for it if necessary."""
        deadline = _deadline(timeout_sec)
        woken = False
        while not self._is_shutdown and not until():
            if not self._context.ok():
                raise ExternalShutdownException
            if self._run_ready():
                return
            self._look_around()
            if self._run_ready():
                return
            if woken:  # by something else than a message or a timer
                self._report_events()
            left = _left(deadline)
            if left <= 0:
                return
            woken = self._wait(min(left, LONGEST_WAIT))

    def _run_ready(self) -> bool:
        """Run the first callback of this round that has something to do; False if none has."""
        while self._ready:
            entity = self._ready.popleft()
            if entity._node in self._nodes and entity.execute():
                return True
        return False

    def _look_around(self) -> None:
        """Begin a round, in which everything has one turn, so that a busy topic does not keep the others waiting."""
        if self._outdated:
            self._outdated = False
            self._timers = tuple(timer for node in self._nodes for timer in node.timers)
            self._subscriptions = tuple(subscription for node in self._nodes for subscription in node.subscriptions)
            self._renew_wait_set()
        self._ready.extend(self._timers)
        self._ready.extend(self._subscriptions)

    def _wait(self, timeout: float) -> bool:
        """Wait for a message, an event, a timer or :meth:`wake`; True unless time ran out."""
        for timer in self._timers:
            next_call = timer.time_until_next_call()
            if next_call is not None:
                timeout = min(timeout, next_call / 1e9)
        if timeout <= 0 or self._wait_set is None:
            return False
        try:
            return bool(self._wait_set.wait(int(timeout * 1e9)))
        except DDSException:
            if self._context.ok() and not self._is_shutdown:
                raise
            return False

    def _report_events(self) -> None:
        with suppress(DDSException, RCLError):  # shut down at this moment
            self._guard.take()
            self._context.graph.listen()
        for node in self._nodes:
            for endpoint in (*node.publishers, *node.subscriptions):
                endpoint.report_events()

    def _renew_wait_set(self) -> None:
        """Wait for what there is now. It is made anew because entities come and go on other threads."""
        self._close_wait_set()
        try:
            with lock:
                wait_set = self._wait_set = WaitSet(self._context.participant)
                wait_set.attach(self._guard)
                wait_set.attach(self._context.graph.changes)
        except (DDSException, RCLError):
            if self._context.ok() and not self._is_shutdown:
                raise
            return
        for node in self._nodes:
            for endpoint in (*node.publishers, *node.subscriptions):
                for source in endpoint.event_sources():
                    with suppress(DDSException):  # destroyed at this moment, which wakes us again
                        wait_set.attach(source)

    def _close_wait_set(self) -> None:
        wait_set, self._wait_set = self._wait_set, None
        if wait_set is not None:
            close(wait_set)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.shutdown()


Executor = SingleThreadedExecutor


def _deadline(timeout_sec: float | None) -> float | None:
    return None if timeout_sec is None or timeout_sec < 0 else time.monotonic() + timeout_sec


def _left(deadline: float | None) -> float:
    return float("inf") if deadline is None else deadline - time.monotonic()


def __getattr__(name: str) -> Any:
    if name == "MultiThreadedExecutor":
        raise NeedsRealROSError(name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
