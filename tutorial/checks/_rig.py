"""What a controller is tried in without a middleware: a body that nothing moves, and a node in memory."""

from __future__ import annotations

import inspect
import threading
import time
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from typing import Any, cast

import mujoco
from builtin_interfaces.msg import Time
from rclpy.clock import Clock
from rclpy.expand_topic_name import expand_topic_name
from rclpy.logging import get_logger

from tutorial.body import Body
from tutorial.checks._answer import missing
from tutorial.checks._cases import call
from tutorial.checks._diagnose import AT_ONCE, Misuse, lacks_self, no_self
from tutorial.checks._watch import Failure, watch
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.paths import HOME
from tutorial.world import Placement, compose

__all__ = ["APART", "MODELS", "Endpoint", "MemoryNode", "Rig", "Sent", "Watched", "check_has"]

MODELS = HOME / "project" / "models"
NOTHING = "nothing is left"
QUIET = 0.05  # [s] after which a thread of the learner's has published what it was going to

APART = "Most likely a timer or a thread publishes, by the wall clock: publish in control, and count steps, io.step."
IN_STOP = "Most likely stop destroys what configure has made, and a restart finds none: do so in unconfigure."
THE_NODE = "config.node belongs to the whole program: unconfigure destroys only the {0}, {1}."
TOO_MANY = "Most likely one is made at every start, or by super().configure(config), too: make one {0}, in configure."
LEFT = "Most likely unconfigure lacks {1}: a flag, None or self.{0}.destroy() does not tell the node."


class Endpoint:
    """A publisher or a subscription of a `MemoryNode`.

    Attributes:
        kind: the class of its messages.
        topic_name: the topic's full name.
        callback: a subscription's; None for a publisher.
        depth: how many messages a subscription keeps while its thread is busy.
        destroyed: whether the learner has destroyed it.
    """

    def __init__(self, node: MemoryNode, kind: type, topic: str, qos: Any, callback: Any = None) -> None:
        self.topic_name = self.topic = expand_topic_name(topic, "tank", node.namespace)
        self.kind, self.callback, self.destroyed = kind, callback, False
        self.depth = getattr(qos, "depth", qos)
        self._node = node

    def publish(self, message: Any) -> None:
        """Keep a message, as the node is told to."""
        if self.destroyed:
            raise Misuse(f"it publishes on {self.topic} with a publisher that is destroyed", IN_STOP)
        if not isinstance(message, self.kind):
            raise TypeError(f"Expected {self.kind}, got {type(message)}")
        self._node.publish(self, message)

    def destroy(self) -> None:
        """Take it back; the node is not told."""
        self.destroyed = True

    def get_subscription_count(self) -> int:
        """Say that somebody is there."""
        return 1

    get_publisher_count = get_subscription_count


class MemoryNode:
    """As much of rclpy's node as a controller uses. No message leaves it.

    Args:
        publish: takes a publisher and what it publishes.
        namespace: of its topics.

    Attributes:
        publishers, subscriptions: those that it has; also one that was destroyed without telling it.
        made: those that were ever made.
        timers: what `create_timer` was given; none of them ever fires.
        destroyed: whether the learner has destroyed the node itself.
    """

    def __init__(self, publish: Callable[[Endpoint, Any], None], namespace: str = "/") -> None:
        self.publish, self.namespace, self.destroyed = publish, namespace, False
        self.publishers, self.subscriptions, self.made = list[Endpoint](), list[Endpoint](), list[Endpoint]()
        self.timers: list[tuple[Any, ...]] = []

    def create_publisher(self, msg_type: type, topic: str, qos_profile: Any, **_: Any) -> Endpoint:
        """Make a publisher."""
        return self._keep(Endpoint(self, msg_type, topic, qos_profile), self.publishers)

    def create_subscription(self, msg_type: type, topic: str, callback: Any, qos_profile: Any, **_: Any) -> Endpoint:
        """Make a subscription; `Rig.hear` brings it messages."""
        check_callback(callback, msg_type)
        return self._keep(Endpoint(self, msg_type, topic, qos_profile, callback), self.subscriptions)

    def create_timer(self, *arguments: Any) -> None:
        """Note that a timer was asked for."""
        self.timers.append(arguments)

    def destroy_publisher(self, endpoint: Endpoint) -> bool:
        """Take a publisher or a subscription back; whether there was one."""
        kept = self.publishers if endpoint in self.publishers else self.subscriptions
        if endpoint not in kept:
            return False
        kept.remove(endpoint)
        endpoint.destroy()
        return True

    destroy_subscription = destroy_publisher

    def check_left(self) -> str:
        """Say that the learner has left nothing behind.

        Raises:
            Failure: something is left.
        """
        kept = [*self.publishers, *self.subscriptions]
        if not kept and not self.destroyed:
            return NOTHING
        alone = " and was not told of its end" * any(each.destroyed for each in kept)
        left = f"the node still has {len(kept)} of {len(self.made)} topics{alone}"
        cause = TOO_MANY if len(kept) < len(self.made) else LEFT
        if self.destroyed:
            left, cause = "the program's node is gone", THE_NODE
        kind = "subscription" if self.subscriptions else "publisher"
        raise Failure("unconfigure", Misuse(left, cause.format(kind, f"self.node.destroy_{kind}(self.{kind})")))

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

    def _keep(self, endpoint: Endpoint, kept: list[Endpoint]) -> Endpoint:
        self.made.append(endpoint)
        kept.append(endpoint)
        return endpoint


def check_callback(callback: Any, message_type: type) -> None:
    """Refuse a callback that cannot work, in the learner's words.

    Raises:
        Misuse: it is not a function, or one that cannot take a message.
    """
    name = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in message_type.__name__)
    if not callable(callback):
        text = f"create_subscription is given {callback!r} in place of a function"
        raise Misuse(text, AT_ONCE.format(f"on{name}"))
    if inspect.iscoroutinefunction(callback):
        text = f"{callback.__name__} is a coroutine function, async def, and nobody awaits it"
        raise Misuse(text, "A callback is a plain function: it puts the message away, or posts a call, and returns.")
    if inspect.ismethod(callback) and lacks_self(callback.__func__):
        raise Misuse(f"{callback.__name__} cannot take a message", no_self(callback.__func__))


class Watched:
    """The learner's controller, each call of which is watched.

    Args:
        controller_class: the learner's class.

    Attributes:
        inner: the learner's controller.
    """

    def __init__(self, controller_class: type[SimpleController]) -> None:
        with watch.call("__init__"):
            self.inner = controller_class()

    def __getattr__(self, method: str) -> Callable[..., None]:
        def call(*arguments: Any) -> None:
            with watch.call(method):
                getattr(self.inner, method)(*arguments)

        return call


@dataclass(frozen=True)
class Sent:
    """A message that was published.

    Attributes:
        topic: its full name.
        step: the simulation's at which it was published. If another thread than the simulation's has published it,
            that of its stamp.
        stamp_ns: its stamp [ns]; 0 where it has none.
        message: a copy of it.
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
        node: a real one; None for one in memory.

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
        node: Any = None,
    ) -> None:
        self.displayed, self.body = _bodies(model, name)
        mujoco.mj_resetData(self.body.model, self.body.data)
        self.before, self.after, self.sent = before, after, list[Sent]()
        self.io = ControllerIO(self.body, time_step)
        self.node = node or cast("Any", MemoryNode(self._publish, namespace))
        self._answer = answer
        self._thread, self._threads = threading.current_thread(), set(threading.enumerate())
        self.learner = Watched(answer)
        self.learner.configure(ControllerConfig(self.displayed, self.node, _drop, _drop))

    def start(self, step: int = 0) -> None:
        """Begin to simulate, at a step; also again, after `stop`."""
        self.begun = self.io.step = step
        self.learner.initialize(self.io)
        if [*self.node.timers]:
            raise Failure("configure", Misuse("it makes a timer", APART))
        if "thread" in watch.noted and missing(self._answer, "control"):
            raise Failure("initialize", Misuse("it starts a thread of its own", APART), watch.noted["thread"])
        check_has(self._answer, "control")

    def advance(self, steps: int) -> None:
        """Simulate some steps."""
        for _ in range(steps):
            self.before()
            self.learner.control()
            self.after()
            self.io.step += 1

    def hear(self, message: Any) -> None:
        """Bring a message to whatever subscribes to its kind."""
        for each in self.node.subscriptions:
            if each.kind is type(message):
                call(each.callback, message)

    def on(self, kind: type, topic: str) -> str:
        """Say on which topic messages of this kind are sent or heard: on this one, where it is among them."""
        made = [each.topic for each in self.node.made if each.kind is kind]
        wanted = expand_topic_name(topic, "tank", self.node.namespace)
        return f"{kind.__name__} on {wanted if wanted in made else ', '.join(made) or 'no topic'}"

    def stop(self) -> None:
        """Simulate no more; wait for what threads of the learner's still publish."""
        self.has_threads = bool(set(threading.enumerate()) - self._threads)
        self.learner.stop()
        before = -1
        while len(self.sent) > before and set(threading.enumerate()) - self._threads:
            before = len(self.sent)
            time.sleep(QUIET)

    def leave(self) -> str:
        """Have the controller leave its body, and say that it has left nothing behind."""
        check_has(self._answer, "unconfigure", misspelled=True)
        self.learner.unconfigure()
        return str(self.node.check_left())

    def _publish(self, publisher: Endpoint, message: Any) -> None:
        stamp = message.header.stamp if hasattr(message, "header") else Time()
        stamp_ns, step = stamp.sec * 1_000_000_000 + stamp.nanosec, self.io.step
        if threading.current_thread() is not self._thread:
            step = round(stamp_ns / 1e9 / self.io.time_step)
        self.sent.append(Sent(publisher.topic, step, stamp_ns, deepcopy(message)))


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
        raise Failure(method, Misuse(lacking.text, lacking.cause))


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
