"""What a controller is tried in without a middleware: a body on which nothing moves by itself, step by step."""

import threading
import time
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from typing import Any, cast

import mujoco
from builtin_interfaces.msg import Time
from rclpy.expand_topic_name import expand_topic_name

from tutorial.body import Body
from tutorial.checks._answer import check_has, has
from tutorial.checks._cases import call
from tutorial.checks._diagnose import Misuse
from tutorial.checks._node import Endpoint, MemoryNode
from tutorial.checks._watch import Failure, watch
from tutorial.controller import ControllerConfig, ControllerIO
from tutorial.paths import HOME
from tutorial.world import Placement, compose

MODELS = HOME / "project" / "models"
QUIET = 0.05  # [s] after which a thread of the learner's has published what it was going to

APART = "Most likely a timer or a thread publishes, by the wall clock: publish in control, and count steps, io.step."


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

    def on(self, kind: type, topic: str) -> str:
        """Say on which topic messages of this kind are sent or heard: on this one, where it is among them."""
        made = [each.topic_name for each in self.node.made if each.kind is kind]
        wanted = expand_topic_name(topic, "tank", self.node.namespace)
        return f"{kind.__name__} on {wanted if wanted in made else ', '.join(made) or 'no topic'}"

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
        check_has(self._answer, "unconfigure")
        self.do("unconfigure")
        return str(self.node.check_left())

    def _publish(self, publisher: Endpoint, message: Any) -> None:
        stamp = message.header.stamp if hasattr(message, "header") else Time()
        stamp_ns, step = stamp.sec * 1_000_000_000 + stamp.nanosec, self.io.step
        if threading.current_thread() is not self._thread:
            step = round(stamp_ns / 1e9 / self.io.time_step)
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
