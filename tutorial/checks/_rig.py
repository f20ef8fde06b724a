"""What a controller is tried in without a middleware: a node in memory, and a body on which nothing moves by itself."""

import inspect
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, cast

import mujoco
from builtin_interfaces.msg import Time
from rclpy.clock import Clock
from rclpy.expand_topic_name import expand_topic_name
from rclpy.logging import get_logger
from rclpy.node import Node

from tutorial.body import Body
from tutorial.checks._answer import check_has, has
from tutorial.checks._cases import Case, call
from tutorial.checks._diagnose import AT_ONCE
from tutorial.checks._interleave import interleave
from tutorial.checks._watch import Failure, Misuse, watch
from tutorial.controller import ControllerConfig, ControllerIO
from tutorial.errors import TutorialError
from tutorial.paths import HOME
from tutorial.ros.node_thread import SpinThread
from tutorial.world import Placement, compose

MODELS = HOME / "project" / "models"
QUIET = 0.05  # [s] after which a thread of the learner's has published what it was going to

APART = "Most likely a timer or a thread publishes, by the wall clock: publish in control, and count steps, io.step."
MESSAGES = 100  # that come while a controller is configured, one at every instruction
PATIENCE = 10.0  # [s]; only what never comes takes so long

IN_STOP = "Most likely stop destroys what configure has made, and a restart finds none: do so in unconfigure."
THE_NODE = "config.node belongs to the whole program: unconfigure destroys only the {0}, {1}."
TOO_MANY = "Most likely one is made at every start, or by super().configure(config), too: make one {0}, in configure."
EARLY = "Most likely the subscription is created before what its callback uses, so it finds nothing: create it last."
LEFT = "Most likely unconfigure is missing, or lacks {1}: a flag, None or self.{0}.destroy() does not tell the node."


class Endpoint:
    """A publisher or a subscription of a `MemoryNode`.

    Attributes:
        kind: the class of its messages.
        topic_name: the topic's full name.
        callback: a subscription's; None for a publisher.
        depth: how many messages a subscription keeps while its thread is busy.
        destroyed: whether the learner has destroyed it.
    """

    def __init__(self, node: "MemoryNode", kind: type, topic: str, qos: Any, callback: Any = None) -> None:
        self.topic_name = expand_topic_name(topic, "tank", node.namespace)
        self.kind, self.callback, self.destroyed = kind, callback, False
        self.depth = getattr(qos, "depth", qos)
        self._node = node

    def publish(self, message: Any) -> None:
        """Keep a message, as the node is told to."""
        if self.destroyed:
            raise Misuse(f"it publishes on {self.topic_name} with a publisher that is destroyed", IN_STOP)
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
        get_clock, get_logger, get_name, get_namespace, destroy_publisher, destroy_subscription: as rclpy's.
        made: the publishers and subscriptions that were ever made.
        kept: those that it has; also one that was destroyed without telling it.
        destroyed: whether the learner has destroyed the node itself.
    """

    def __init__(self, publish: Callable[[Endpoint, Any], object] = lambda *_: None, namespace: str = "/") -> None:
        self.publish, self.namespace, self.destroyed = publish, namespace, False
        self.made, self.kept = list[Endpoint](), list[Endpoint]()
        self.get_clock, self.get_logger = Clock, partial(get_logger, "tank")
        self.destroy_publisher, self.destroy_subscription = partial(self._drop, False), partial(self._drop, True)
        self.get_name, self.get_namespace = (lambda: "tank"), (lambda: namespace)

    def create_publisher(self, msg_type: type, topic: str, qos_profile: Any, **_: Any) -> Endpoint:
        """Make a publisher."""
        return self._keep(Endpoint(self, msg_type, topic, qos_profile))

    def create_subscription(self, msg_type: type, topic: str, callback: Any, qos_profile: Any, **_: Any) -> Endpoint:
        """Make a subscription."""
        check_callback(callback, msg_type)
        return self._keep(Endpoint(self, msg_type, topic, qos_profile, callback))

    def create_timer(self, *_: Any) -> None:
        """Have `watch` note that a timer was asked for, which never fires: ``"timer"``."""
        watch.note("timer", sys._getframe())

    @property
    def subscriptions(self) -> list[Endpoint]:
        """The subscriptions that it has."""
        return [each for each in self.kept if each.callback]

    def listeners(self, message: Any) -> list[Any]:
        """Return the callbacks of whatever subscribes to a message's kind."""
        return [each.callback for each in self.subscriptions if each.kind is type(message)]

    def on(self, kind: type, topic: str) -> str:
        """Say on which topic messages of this kind are sent or heard: on this one, where it is among them."""
        made = [each.topic_name for each in self.made if each.kind is kind]
        wanted = expand_topic_name(topic, "tank", self.namespace)
        return f"{kind.__name__} on {wanted if wanted in made else ', '.join(made) or 'no topic'}"

    def check_left(self) -> str:
        """Say that the learner has left nothing behind.

        Raises:
            Failure: something is left.
        """
        if not self.kept and not self.destroyed:
            return "nothing is left"
        alone = " and was not told of its end" * any(each.destroyed for each in self.kept)
        left = f"the node still has {len(self.kept)} of {len(self.made)} topics{alone}"
        cause = TOO_MANY if len(self.kept) < len(self.made) else LEFT
        if self.destroyed:
            left, cause = "the program's node is gone", THE_NODE
        kind = "subscription" if self.subscriptions else "publisher"
        raise Failure("unconfigure", Misuse(left, cause.format(kind, f"self.node.destroy_{kind}(self.{kind})")))

    def destroy_node(self) -> None:
        """Note that the whole node was destroyed."""
        self.destroyed = True

    def _drop(self, has_callback: bool, endpoint: Endpoint) -> bool:
        is_there = endpoint in self.kept and bool(endpoint.callback) == has_callback
        if is_there:
            self.kept.remove(endpoint)
            endpoint.destroy()
        return is_there

    def _keep(self, endpoint: Endpoint) -> Endpoint:
        self.made.append(endpoint)
        self.kept.append(endpoint)
        return endpoint


def early(make: Callable[..., Any], message: Any) -> Case:
    """Observe whether the callback can run as soon as there is a subscription, while `configure` goes on.

    Args:
        make: makes what an answer is tried in, and has it configured, given the answer and a node.
        message: comes again and again, between any two instructions of `configure`.
    """

    def case(answer: Any) -> str:
        def come() -> None:
            for callback, _ in zip(node.listeners(message), left):
                try:
                    call(callback, message)
                except Failure as failure:
                    text = f"the first message comes while configure runs: {failure.error}"
                    raise Failure(failure.method, Misuse(text, EARLY), failure.place) from failure

        node, left = MemoryNode(), iter(range(MESSAGES))
        interleave(lambda: make(answer, node=node), come, None)
        return "it can be taken"

    return case


def check_callback(callback: Any, message_type: type) -> None:
    """Refuse a callback that cannot work, in the learner's words.

    Raises:
        Misuse: it is not a function, or a coroutine function.
    """
    name = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in message_type.__name__)
    if not callable(callback):
        text = f"create_subscription is given {callback!r} in place of a function"
        raise Misuse(text, AT_ONCE.format(f"on{name}"))
    if inspect.iscoroutinefunction(callback):
        text = f"{callback.__name__} is a coroutine function, async def, and nobody awaits it"
        raise Misuse(text, "A callback is a plain function: it puts the message away, or posts a call, and returns.")


@contextmanager
def ros_node() -> Iterator[Any]:
    """Make a node whose callbacks run on a thread of its own."""
    with SpinThread(Node, "tank") as thread:
        yield thread.node


def send(node: Any, topic: str, message: Any, done: Callable[[], object]) -> None:
    """Publish a message for the learner's subscription, and wait until something has come of it.

    Args:
        node: the learner's.
        topic: the topic.
        message: what to publish.
        done: whether something has come of it.

    Raises:
        TutorialError: the message does not arrive.
    """
    publisher = node.create_publisher(type(message), topic, 10)
    wait(publisher.get_subscription_count, "no message reaches the subscription. Is its QoS 1?")
    publisher.publish(message)
    wait(done, "nothing comes of a message from another program")


def wait(condition: Callable[[], object], complaint: str) -> None:
    """Wait until something is so.

    Raises:
        TutorialError: it never is, with the complaint.
    """
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            raise TutorialError(complaint)
        time.sleep(0.0005)


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
        learner: the learner's controller.
        io: what it is given; it knows the step.
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
        with watch.call("__init__"):
            self.learner = answer()
        self.do("configure", ControllerConfig(self.displayed, self.node, _drop, _drop))

    def do(self, method: str, *arguments: Any) -> None:
        """Call one of the learner's methods."""
        with watch.call(method):
            getattr(self.learner, method)(*arguments)

    def start(self, step: int = 0) -> None:
        """Begin to simulate, at a step; also again, after `stop`."""
        self.begun = self.io.step = step
        self.do("initialize", self.io)
        if place := watch.noted.pop("timer", None):
            raise Failure(place.function, Misuse("it makes a timer", APART), place)
        if not has(self._answer, "control") and (place := watch.noted.get("thread")):
            raise Failure(place.function, Misuse("it starts a thread of its own", APART), place)

    def advance(self, steps: int) -> None:
        """Simulate some steps."""
        check_has(self._answer, "control")
        for _ in range(steps):
            self.before()
            self.do("control")
            self.after()
            self.io.step += 1

    def hear(self, message: Any) -> None:
        """Bring a message to whatever subscribes to its kind."""
        for callback in self.node.listeners(message):
            call(callback, message)

    def stop(self) -> None:
        """Simulate no more; wait for what threads of the learner's still publish."""
        self.has_threads = bool(set(threading.enumerate()) - self._threads)
        self.do("stop")
        before = -1
        while len(self.sent) > before and set(threading.enumerate()) - self._threads:
            before = len(self.sent)
            time.sleep(QUIET)

    def leave(self) -> str:
        """Have the controller leave its body, and say that it has left nothing behind."""
        self.do("unconfigure")
        return str(self.node.check_left())

    def _publish(self, publisher: Endpoint, message: Any) -> None:
        stamp = message.header.stamp if hasattr(message, "header") else Time()
        # Whole seconds in nanosec count twice, so that they show.
        stamp_ns = (stamp.sec + stamp.nanosec // 10**9) * 10**9 + stamp.nanosec
        is_here = threading.current_thread() is self._thread
        step = self.io.step if is_here else round(stamp_ns / 1e9 / self.io.time_step)
        self.sent.append(Sent(publisher.topic_name, step, stamp_ns, deepcopy(message)))


@cache
def model_of(model: str, name: str) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Make a body's model, and a state of it to compute with."""
    if model.startswith("<"):
        made = mujoco.MjModel.from_xml_string(model)
    else:
        made = compose([Placement(name, MODELS / f"{model}.xml")])
    return made, mujoco.MjData(made)


@cache
def _bodies(model: str, name: str) -> tuple[Body, Body]:
    """Make a displayed body and a simulated one."""
    made, _ = model_of(model, name)
    return Body(name, made, mujoco.MjData(made)), Body(name, made, mujoco.MjData(made))


def _drop(*_: object) -> None:
    pass
