"""A ROS 2 node on a thread of its own, and what it counts about its topics."""

from __future__ import annotations

import inspect
import logging
import math
import statistics
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from tutorial.errors import where
from tutorial.trace import HandoffTrace

__all__ = ["MeteredNode", "NodeThread", "TopicMeter"]

LATENCIES_KEPT = 10_000
LOOK = 0.05  # [s] between two looks whether the thread is to end
STUCK = 3.0  # [s] that a callback may take to return when its node is closed

_log = logging.getLogger(__name__)


class TopicMeter:
    """Counts the messages of one topic that a program publishes or receives.

    Attributes:
        topic: its full name.
        type_name: its type, such as ``sensor_msgs/msg/Joy``.
        direction: ``"published"`` or ``"received"``.
        count: how many messages so far.
        last: the newest of them.
    """

    def __init__(self, topic: str, message_type: type, direction: str) -> None:
        self.topic = topic
        self.type_name = f"{message_type.__module__.split('.')[0]}/msg/{message_type.__name__}"
        self.direction = direction
        self.count = 0
        self.last: Any = None
        self._first_at = self._last_at = 0.0
        self._latencies_ns: deque[int] = deque(maxlen=LATENCIES_KEPT)

    def add(self, message: Any, latency_ns: int | None = None) -> None:
        """Count one message.

        Args:
            message: the message.
            latency_ns: from its publication to its callback [ns], where that is known.
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
        """Whether these are joint states that the program receives."""
        return self.direction == "received" and self.type_name == "sensor_msgs/msg/JointState"

    @property
    def idle(self) -> float:
        """How long ago the last message was [s]; infinite before the first."""
        return time.monotonic() - self._last_at if self.count else math.inf

    @property
    def rate(self) -> float:
        """Messages per second between the first and the last one [Hz]; 0 before there are two."""
        span = self._last_at - self._first_at
        return (self.count - 1) / span if self.count > 1 and span > 0 else 0.0

    def latency_ms(self) -> dict[str, float | None]:
        """Return median and 99th percentile of the time from publication to callback [ms]; None where unknown."""
        milliseconds = [ns / 1e6 for ns in self._latencies_ns.copy()]  # a copy, for messages may go on arriving
        if len(milliseconds) < 2:
            return {"median": None, "p99": None}
        p99 = statistics.quantiles(milliseconds, n=100, method="inclusive")[98]
        return {"median": round(statistics.median(milliseconds), 3), "p99": round(p99, 3)}


class MeteredNode(Node):  # type: ignore[misc, unused-ignore]
    """A node that counts what goes over the topics it makes. In everything else it is rclpy's.

    Attributes:
        meters: one for each topic and direction, in the order in which they were made.
        trace: where to write down when each message's callback begins and ends; None for nowhere.
    """

    trace: HandoffTrace | None = None

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.meters: list[TopicMeter] = []
        super().__init__(*args, **kwargs)
        self.meters.clear()  # rclpy's own topics, such as /parameter_events

    def create_publisher(self, msg_type: type, topic: str, *args: Any, **kwargs: Any) -> Any:
        """Create a publisher, as rclpy does, that counts what it publishes."""
        publisher: Any = super().create_publisher(msg_type, topic, *args, **kwargs)
        meter = self._meter(publisher.topic_name, msg_type, "published")
        publish = publisher.publish

        def metered(message: Any) -> None:
            publish(message)
            meter.add(message)

        publisher.publish = metered
        return publisher

    def create_subscription(
        self, msg_type: type, topic: str, callback: Callable[..., Any], *args: Any, **kwargs: Any
    ) -> Any:
        """Create a subscription, as rclpy does, that counts what it receives and how long it took."""
        meter: TopicMeter | None = None
        count = next((count for count in (1, 2) if _accepts(callback, count)), 0)  # the message alone, as in rclpy

        def metered(message: Any, info: dict[str, int]) -> None:
            if meter is not None:
                meter.add(message, time.time_ns() - info["source_timestamp"])
            arguments = (message, info)[:count]
            if self.trace is None:
                callback(*arguments)
                return
            with self.trace.receiving(meter.topic if meter is not None else topic):
                callback(*arguments)

        heard = metered if count else callback  # which rclpy refuses
        subscription = super().create_subscription(msg_type, topic, heard, *args, **kwargs)
        meter = self._meter(subscription.topic_name, msg_type, "received")
        return subscription

    def _meter(self, topic: str, message_type: type, direction: str) -> TopicMeter:
        meter = TopicMeter(topic, message_type, direction)
        self.meters.append(meter)
        return meter


class NodeThread:
    """A node whose callbacks run on a thread of its own, with a context and an executor of its own.

    Args:
        name: the node's name, unless it is remapped.
        args: command line arguments, of which ROS 2 takes those after ``--ros-args``.

    Attributes:
        node: the node.
        error: what a callback raised last, SystemExit included; None when none did.
    """

    def __init__(self, name: str, args: Sequence[str] | None = None) -> None:
        self.error: BaseException | None = None
        self._context = Context()
        rclpy.init(args=list(args or ()), context=self._context)
        try:
            self.node = MeteredNode(name, context=self._context)
            self._executor = SingleThreadedExecutor(context=self._context)
            self._executor.add_node(self.node)
        except BaseException:
            self._context.try_shutdown()
            raise
        self._stopping = threading.Event()
        self._closed = False
        self._thread = threading.Thread(target=self._spin, name="executor", daemon=True)
        self._thread.start()

    def __enter__(self) -> NodeThread:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def namesakes(self) -> int:
        """Return how many nodes in the domain have this node's full name, this one included."""
        mine = (self.node.get_name(), self.node.get_namespace())
        return self.node.get_node_names_and_namespaces().count(mine)

    def close(self) -> None:
        """End the thread, then the executor, the node and the context, in this order. Idempotent.

        A callback that does not return keeps its thread, which then ends with the process.
        """
        if self._closed:
            return
        self._stopping.set()
        self._thread.join(STUCK)
        if self._thread.is_alive():
            _log.error("a callback of the node %r does not return%s", self.node.get_name(), where(self._thread))
        else:
            self._executor.shutdown()
            self.node.destroy_node()
            self._context.try_shutdown()
        self._closed = True

    def _spin(self) -> None:
        while self._context.ok() and not self._stopping.is_set():
            try:
                self._executor.spin_once(timeout_sec=LOOK)
            except BaseException as error:  # noqa: BLE001 - a callback may raise anything, and SystemExit is common
                if not self._context.ok():
                    return
                self.error = error
                _log.exception("a callback of the node %r failed; the others go on", self.node.get_name())


def _accepts(callback: Callable[..., Any], count: int) -> bool:
    try:
        inspect.signature(callback).bind(*[None] * count)
    except (TypeError, ValueError):
        return False
    return True
