"""What a controller is tried in without a middleware: a body that nothing moves, and a node in memory."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from typing import Any

import mujoco
from builtin_interfaces.msg import Time
from rclpy.clock import Clock
from rclpy.exceptions import InvalidHandle
from rclpy.expand_topic_name import expand_topic_name
from rclpy.logging import get_logger

from tutorial.body import Body
from tutorial.checks._answer import missing
from tutorial.checks._cases import call
from tutorial.checks._diagnose import Misuse
from tutorial.checks._node import check_callback
from tutorial.checks._watch import Failure
from tutorial.checks._world import MODELS, Watched
from tutorial.controller import ControllerConfig, ControllerIO
from tutorial.world import Placement, compose

__all__ = ["Endpoint", "MemoryNode", "Rig", "Sent", "check_has", "elsewhere"]

QUIET = 0.05  # [s] after which a thread of the learner's has published what it was going to

TIMER = (
    "Most likely a timer publishes: it goes by the wall clock, on the executor's thread. Count steps in control: "
    "simulated time is io.step * io.time_step."
)


class Endpoint:
    """A publisher or a subscription of a `MemoryNode`.

    Attributes:
        kind: the class of its messages.
        topic_name: the topic's full name.
        callback: a subscription's; None for a publisher.
        destroyed: whether the learner has destroyed it.
        by_itself: whether that was done without asking the node.
        depth: how many messages a subscription keeps while its thread is busy; 0 for all.
    """

    depth = 0

    def __init__(self, node: MemoryNode, kind: type, topic: str, callback: Any = None) -> None:
        self.topic_name = self.topic = expand_topic_name(topic, "tank", node.namespace)
        self.kind, self.callback, self.destroyed, self.by_itself = kind, callback, False, False
        self._node = node

    def publish(self, message: Any) -> None:
        """Keep a message, as the node is told to."""
        if self.destroyed:
            raise InvalidHandle
        if not isinstance(message, self.kind):
            raise TypeError(f"Expected {self.kind}, got {type(message)}")
        self._node.publish(self, message)

    def destroy(self) -> None:
        """Take it back; the node is not told."""
        self.destroyed = self.by_itself = True

    def get_subscription_count(self) -> int:
        """Say that somebody listens."""
        return 1

    def get_publisher_count(self) -> int:
        """Say that somebody publishes."""
        return 1


class MemoryNode:
    """As much of rclpy's node as a controller uses. No message leaves it.

    Args:
        publish: takes a publisher and what it publishes.
        namespace: of its topics.

    Attributes:
        publishers, subscriptions: those that were made, destroyed or not, in the order in which they were made.
        timers: what `create_timer` was given; none of them ever fires.
        destroyed: whether the learner has destroyed the node itself.
    """

    def __init__(self, publish: Callable[[Endpoint, Any], None], namespace: str = "/") -> None:
        self.publish, self.namespace = publish, namespace
        self.publishers: list[Endpoint] = []
        self.subscriptions: list[Endpoint] = []
        self.timers: list[tuple[Any, ...]] = []
        self.destroyed = False

    def create_publisher(self, msg_type: type, topic: str, qos_profile: Any, **_: Any) -> Endpoint:
        """Make a publisher; its depth does not matter."""
        del qos_profile
        self.publishers.append(Endpoint(self, msg_type, topic))
        return self.publishers[-1]

    def create_subscription(self, msg_type: type, topic: str, callback: Any, qos_profile: Any, **_: Any) -> Endpoint:
        """Make a subscription; a case calls its `Endpoint.callback` itself."""
        check_callback(callback, msg_type)
        self.subscriptions.append(Endpoint(self, msg_type, topic, callback))
        self.subscriptions[-1].depth = getattr(qos_profile, "depth", qos_profile)
        return self.subscriptions[-1]

    def create_timer(self, *arguments: Any) -> None:
        """Note that a timer was asked for."""
        self.timers.append(arguments)

    def destroy_publisher(self, publisher: Endpoint) -> bool:
        """Take a publisher back; whether there was one."""
        return self._take_back(publisher, self.publishers)

    def destroy_subscription(self, subscription: Endpoint) -> bool:
        """Take a subscription back; whether there was one."""
        return self._take_back(subscription, self.subscriptions)

    def _take_back(self, endpoint: Endpoint, made: list[Endpoint]) -> bool:
        if endpoint not in made or endpoint.destroyed:
            return False
        endpoint.destroyed = True
        return True

    def left(self) -> str:
        """Say what the learner has left behind."""
        if self.destroyed:
            return "the program's node is gone"
        made = (*self.publishers, *self.subscriptions)
        left = sum(not each.destroyed for each in made)
        if left:
            return f"{left} of {len(made)} topics are still there"
        return (
            "the node still counts what has destroyed itself" * any(each.by_itself for each in made)
            or "nothing is left"
        )

    def destroy_node(self) -> None:
        """Note that the whole node was destroyed."""
        self.destroyed = True

    def get_clock(self) -> Clock:
        """Return the computer's clock."""
        return Clock()

    def get_logger(self) -> Any:
        """Return rclpy's logger."""
        return get_logger("tank")

    def get_name(self) -> str:
        """Return its name."""
        return "tank"

    def get_namespace(self) -> str:
        """Return its namespace."""
        return self.namespace


@dataclass(frozen=True)
class Sent:
    """A message that was published.

    Attributes:
        topic: its full name.
        step: the simulation's at which it was published. If another thread than the simulation's has published it,
            that of its stamp.
        stamp_ns: its stamp [ns]; 0 where it has none.
        message: what is kept of it.
    """

    topic: str
    step: int
    stamp_ns: int
    message: Any


class Rig:
    """A learner's controller on a simulated body, on which nothing moves by itself.

    Args:
        answer: the learner's class.
        before, after: are called before and after `control`, at each step.
        model: the body's model file without ``.xml``, or the model itself, as MJCF.
        name: the body's name.
        time_step: of the simulation [s].
        namespace: of the node.
        keep: returns what is to be kept of a message, a copy.

    Attributes:
        io: what the controller is given; it knows the step.
        displayed, body: the displayed body, and the simulated one.
        node: the learner's.
        sent: what was published.
        begun: the step of the last start.
        has_threads: whether threads of the learner's have run until the last stop.

    Raises:
        Failure: one of the learner's methods raised. So does every method.
    """

    def __init__(
        self,
        answer: type,
        before: Callable[[], None] = lambda: None,
        after: Callable[[], None] = lambda: None,
        model: str = "tank",
        name: str = "Rover",
        time_step: float = 0.001,
        namespace: str = "/",
        keep: Callable[[Any], Any] = deepcopy,
    ) -> None:
        self.displayed, self.body = _bodies(model, name)
        mujoco.mj_resetData(self.body.model, self.body.data)
        self.before, self.after, self.sent = before, after, list[Sent]()
        self.io = ControllerIO(self.body, time_step)
        self.node = MemoryNode(self._publish, namespace)
        self._answer, self._keep = answer, keep
        self._thread, self._threads = threading.current_thread(), set(threading.enumerate())
        self.learner = Watched(answer)
        self.learner.configure(ControllerConfig(self.displayed, self.node, _drop, _drop))  # type: ignore[arg-type]

    def start(self, step: int = 0) -> None:
        """Begin to simulate, at a step; also again, after `stop`."""
        self.begun = self.io.step = step
        self.learner.initialize(self.io)
        if self.node.timers:
            raise Failure("configure", Misuse("it makes a timer", TIMER), None)
        check_has(self._answer, "control")

    def advance(self, steps: int) -> None:
        """Simulate some steps."""
        for _ in range(steps):
            self.before()
            self.learner.control()
            self.after()
            self.io.step += 1

    def stop(self) -> None:
        """Simulate no more; wait for what threads of the learner's still publish."""
        self.has_threads = bool(set(threading.enumerate()) - self._threads)
        self.learner.stop()
        before = -1
        while len(self.sent) > before and set(threading.enumerate()) - self._threads:
            before = len(self.sent)
            time.sleep(QUIET)

    def leave(self) -> str:
        """Have the controller leave its body, and say what it has left behind."""
        check_has(self._answer, "unconfigure", misspelled=True)
        self.learner.unconfigure()
        return self.node.left()

    def _publish(self, publisher: Endpoint, message: Any) -> None:
        stamp = message.header.stamp if hasattr(message, "header") else Time()
        stamp_ns, step = stamp.sec * 1_000_000_000 + stamp.nanosec, self.io.step
        if threading.current_thread() is not self._thread:
            step = round(stamp_ns / 1e9 / self.io.time_step)
        self.sent.append(Sent(publisher.topic, step, stamp_ns, self._keep(message)))


def check_has(answer: type, method: str, misspelled: bool = False) -> None:
    """Look whether a method is there.

    Args:
        answer: the learner's class.
        method: its name.
        misspelled: whether it may be missing, but not misspelled.

    Raises:
        Failure: it is not.
    """
    lacking = missing(answer, method)
    if lacking and ("misspelled" in lacking.cause or not misspelled):
        raise Failure(method, Misuse(lacking.text, lacking.cause), None)


def elsewhere(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call what the learner wrote on another thread, and wait for it.

    Raises:
        Failure: it raised.
    """
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(call, function, *arguments).result()


@cache
def _bodies(model: str, name: str) -> tuple[Body, Body]:
    """Make a displayed body and a simulated one."""
    if model.startswith("<"):
        made = mujoco.MjModel.from_xml_string(model)
        return Body(name, made, mujoco.MjData(made)), Body(name, made, mujoco.MjData(made))
    placement = Placement(name, MODELS / f"{model}.xml")
    composed = compose([placement])
    return Body.displayed(placement), Body(name, composed, mujoco.MjData(composed))


def _drop(*_: object) -> None:
    pass
