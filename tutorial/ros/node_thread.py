"""Run a node on its own thread, and count the messages on its topics."""

from __future__ import annotations

import inspect
import logging
import math
import statistics
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from functools import partial
from typing import Any, ClassVar, Generic, Self, TypeVar

import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node

from tutorial.errors import where
from tutorial.ros.loopback import require_loopback
from tutorial.trace import HandoffTrace

LATENCIES_KEPT = 10_000
LOOK = 0.05  # [s] between checks of whether the thread should end
COMPLAIN_EVERY = 5.0  # [s] between log lines about the same failure
GONE_FOR_GOOD = 1000  # consecutive failed spins on a destroyed entity (about 0.1 s) before the failure is reported

AnyNode = TypeVar("AnyNode", bound=Node)

_log = logging.getLogger(__name__)


Call = Callable[[Any, dict[str, int]], object]
"""Function that is called with a message and rclpy's information about it, such as ``"source_timestamp"`` [ns]."""


class TopicMeter:
    """Counts the messages of one publisher or subscription.

    Args:
        message_type: the class of the messages.
        topic: the topic's full name.
        direction: ``"published"`` or ``"received"``.
        raw: whether messages are received as bytes, to be forwarded or stored.

    Attributes:
        topic, direction, raw: the given values.
        type_name: the topic's type, such as ``sensor_msgs/msg/Joy``.
        count: number of messages counted so far.
        last: the newest message.
    """

    def __init__(self, message_type: type, topic: str, direction: str, raw: bool = False) -> None:
        self.type_name = f"{message_type.__module__.split('.')[0]}/msg/{message_type.__name__}"
        self.topic, self.direction, self.raw = topic, direction, raw
        self.count = 0
        self.last: Any = None
        self._first_at = self._last_at = 0.0
        self._latencies_ns: deque[int] = deque(maxlen=LATENCIES_KEPT)

    def add(self, message: Any, latency_ns: int | None = None) -> None:
        """Count one message.

        Args:
            message: the message.
            latency_ns: time from the message's publication to its callback [ns]; None if unknown.
        """
        self._last_at = time.monotonic()
        if self.count == 0:
            self._first_at = self._last_at
        self.count += 1
        self.last = message
        if latency_ns is not None:
            self._latencies_ns.append(latency_ns)

    @property
    def brings_joint_states(self) -> bool:
        """Whether the messages are joint states that the program receives and displays."""
        return self.direction == "received" and not self.raw and self.type_name == "sensor_msgs/msg/JointState"

    @property
    def idle(self) -> float:
        """Time since the last message [s]; infinite before the first message."""
        return time.monotonic() - self._last_at if self.count else math.inf

    @property
    def rate(self) -> float:
        """Messages per second between the first and the last message [Hz]; 0 until there are two messages."""
        span = self._last_at - self._first_at
        return (self.count - 1) / span if self.count > 1 and span > 0 else 0.0

    def latency_ms(self) -> dict[str, float | None]:
        """Return the median and 99th percentile of the time from publication to callback [ms]; None if unknown."""
        milliseconds = [ns / 1e6 for ns in self._latencies_ns.copy()]  # a copy, because messages can still arrive
        if len(milliseconds) < 2:
            return {"median": None, "p99": None}
        p99 = statistics.quantiles(milliseconds, n=100, method="inclusive")[98]
        return {"median": round(statistics.median(milliseconds), 3), "p99": round(p99, 3)}


class MeteredNode(Node):  # type: ignore[misc, unused-ignore]
    """A node that counts the messages on its topics but otherwise behaves like an rclpy node.

    Messages are not counted if their callback is a coroutine function, which rclpy awaits.

    Attributes:
        meters: a meter for each publisher and subscription, in order of creation.
    """

    def __init__(self, *args: Any, trace: HandoffTrace | None = None, **kwargs: Any) -> None:
        self.meters: list[TopicMeter] = []
        self._trace = trace
        super().__init__(*args, **kwargs)
        self.meters.clear()  # removes the meters of rclpy's own topics, such as /parameter_events

    def create_publisher(self, msg_type: type, topic: str, *args: Any, **kwargs: Any) -> Any:
        """Create a publisher, as rclpy does, and count its messages."""
        publisher: Any = super().create_publisher(msg_type, topic, *args, **kwargs)
        meter, publish = TopicMeter(msg_type, topic, "published"), publisher.publish

        def counted(msg: Any) -> None:
            publish(msg)
            meter.add(msg)

        publisher.publish = counted
        return self._metered(meter, publisher)

    def create_subscription(
        self, msg_type: type, topic: str, callback: Callable[..., Any], *args: Any, **kwargs: Any
    ) -> Any:
        """Create a subscription, as rclpy does, and count its messages."""
        meter = TopicMeter(msg_type, topic, "received", kwargs.get("raw", False))
        call = _called_by_rclpy(callback)
        heard = callback if call is None else partial(self._received, meter, call)
        return self._metered(meter, super().create_subscription(msg_type, topic, heard, *args, **kwargs))

    def _metered(self, meter: TopicMeter, endpoint: Any) -> Any:
        meter.topic = endpoint.topic_name
        self.meters.append(meter)
        return endpoint

    def _received(self, meter: TopicMeter, call: Call, message: Any, info: dict[str, int]) -> None:
        """Count a message and call the callback; if there is a trace, record how long the callback takes."""
        meter.add(message, time.time_ns() - info["source_timestamp"])
        with self._trace.receiving(meter.topic) if self._trace is not None else nullcontext():
            call(message, info)


def _called_by_rclpy(callback: Callable[..., Any]) -> Call | None:
    """Return a function that calls a callback as rclpy does: with one argument if possible, otherwise with two.

    Returns:
        None for a callback that rclpy has to handle itself: a coroutine function, or a callback that rclpy rejects.
    """
    if not inspect.iscoroutinefunction(callback):
        with suppress(TypeError, ValueError):
            inspect.signature(callback).bind(None)
            return lambda message, _info: callback(message)
        with suppress(TypeError, ValueError):
            inspect.signature(callback).bind(None, None)
            return callback
    return None


class SpinThread(Generic[AnyNode]):
    """A node whose callbacks run on its own thread, with its own context and executor.

    Args:
        node_class: the node's class.
        name: the node's name, unless it is remapped.
        args: the command line; ROS 2 reads only the arguments after ``--ros-args``.
        executor: the class of the executor.

    Attributes:
        node: the node.
        error: the last exception that a callback raised, including SystemExit; None if no callback has raised one.
        timeout: how long to wait for a running callback when the node is closed [s]; None to wait forever.
        full_name: the node's full name.
        alive: all instances in this process that have not been closed, whatever the class of their nodes.

    Raises:
        TutorialError: the loopback interface is down.
    """

    alive: ClassVar[set[SpinThread[Any]]] = set()
    error: BaseException | None = None
    timeout: float | None = 3.0

    def __init__(
        self,
        node_class: Callable[..., AnyNode],
        name: str,
        args: Sequence[str] | None = None,
        executor: Callable[..., Executor] = SingleThreadedExecutor,
    ) -> None:
        require_loopback()
        self._context = Context()
        rclpy.init(args=list(args or ()), context=self._context)
        try:
            self.node = node_class(name, context=self._context)
            self._name = self.node.get_name()  # stored, because the program may destroy its node
            self.full_name = self.node.get_fully_qualified_name()
            self._executor = executor(context=self._context)
            self._executor.add_node(self.node)
        except BaseException:
            self._context.try_shutdown()
            raise
        self._stopping = threading.Event()
        self._turn, self._unpaused = threading.Lock(), threading.Event()  # for `paused`
        self._unpaused.set()
        self._is_stuck = False
        self._failure: list[str] = []  # the text of the last logged failure
        self._failed_at = 0.0
        self._unsaid = 0
        self.alive.add(self)
        self._thread = threading.Thread(target=self._spin, name="executor", daemon=True)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Suspend callbacks during the ``with`` block, except a callback that is still running after the timeout."""
        self._is_stuck = True
        self._unpaused.clear()
        try:
            self._is_stuck = not self._turn.acquire(timeout=-1 if self.timeout is None else self.timeout)
            yield
        finally:
            self._unpaused.set()
            if not self._is_stuck:
                self._turn.release()

    def close(self) -> None:
        """Stop the thread, then shut down the executor, destroy the node and shut down the context. Idempotent.

        If a callback does not return in time, stop waiting for it. The node is then destroyed when the callback
        returns, or disappears when the process ends.
        """
        if self not in self.alive:
            return
        self._stopping.set()
        self._thread.join(4 * LOOK if self._is_stuck else self.timeout)  # `paused` has already waited
        if self._thread.is_alive():
            _log.error("a callback of the node %r does not return%s", self._name, where(self._thread))
            threading.Thread(target=self._leave, name="leaving", daemon=True).start()
        else:
            self._leave()
        self.alive.discard(self)

    def _leave(self) -> None:
        self._thread.join()
        running, pool = (getattr(self._executor, name, None) for name in ("_work_tracker", "_executor"))
        if pool is not None and running is not None and running.wait(self.timeout):
            pool.shutdown()  # Jazzy's MultiThreadedExecutor does not wait for its threads
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.try_shutdown()

    def failed(self, error: BaseException) -> None:
        """Store and log an exception that a callback raised; other callbacks continue. Called on the node's thread.

        If the same failure recurs, it is logged only every few seconds, with the number of recurrences: a callback may
        fail a thousand times per second.
        """
        self.error = error
        failure, now = traceback.format_exception_only(error), time.monotonic()
        if failure == self._failure and now - self._failed_at < COMPLAIN_EVERY:
            self._unsaid += 1
            return
        more = f" ({self._unsaid} more like the previous one)" if self._unsaid else ""
        self._failure, self._failed_at, self._unsaid = failure, now, 0
        _log.error("a callback of the node %r failed; other callbacks continue%s", self._name, more, exc_info=error)

    def _spin(self) -> None:
        gone = 0  # consecutive spins that failed on a destroyed entity
        while self._context.ok() and not self._stopping.is_set():
            try:
                with self._turn:
                    self._executor.spin_once(timeout_sec=LOOK)
                gone = 0
            except BaseException as error:  # noqa: BLE001 - a callback can raise anything, and SystemExit is common
                gone = gone + 1 if _met_what_is_destroyed(error) else 0
                if self._context.ok() and gone % GONE_FOR_GOOD == 0:
                    self.failed(error)
            self._unpaused.wait()  # otherwise, this thread would often reacquire the lock before `paused` gets it


def _met_what_is_destroyed(error: BaseException) -> bool:
    """Return whether a spin failed, before it ran any callback, because rclpy tried to wait for a destroyed entity.

    A single failure is harmless: another thread called ``node.destroy_publisher`` after rclpy had listed the node's
    entities, but before rclpy waited for them. Repeated failures mean that the program called an entity's ``destroy``
    method, which does not remove the entity from the node's list.
    """
    frames = traceback.walk_tb(error.__traceback__)
    return isinstance(error, InvalidHandle) and any(f.f_code.co_name == "add_to_wait_set" for f, _ in frames)


class NodeThread(SpinThread[MeteredNode]):
    """A `MeteredNode` on its own thread; see `SpinThread` and `MeteredNode` for the arguments."""

    def __init__(self, name: str, args: Sequence[str] | None = None, trace: HandoffTrace | None = None) -> None:
        super().__init__(partial(MeteredNode, trace=trace), name, args)

    def namesakes(self) -> int:
        """Return the number of known nodes in the domain that have this node's full name, including this node."""
        mine = (self.node.get_name(), self.node.get_namespace())
        try:
            return self.node.get_node_names_and_namespaces().count(mine)
        except (RuntimeError, UnicodeDecodeError):  # the real rclpy lists no nodes while one has an empty name
            return 1
