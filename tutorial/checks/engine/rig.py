"""A rig: a learner's controller on a simulated body that does not move by itself."""

import threading
import time
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from typing import Any, cast

from builtin_interfaces.msg import Time

from tutorial.checks.engine.answer import check_has, has
from tutorial.checks.engine.bodies import bodies
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.memory_node import Endpoint, MemoryNode
from tutorial.checks.engine.trial import Trial
from tutorial.controller import ControllerConfig, ControllerIO

QUIET = 0.05  # [s]; threads that publish nothing for this long have probably finished

APART = (
    "Your code probably publishes from a timer or a thread, so the rate depends on the wall clock. "
    "Publish in control, and count steps: io.step."
)


@dataclass(frozen=True)
class Sent:
    """A published message.

    Attributes:
        topic: the topic's full name.
        step: the simulation step of publication; if a different thread published the message, the step that the stamp
            corresponds to.
        stamp_ns: its stamp [ns]; 0 if the message has no header.
        message: a copy of the message.
    """

    topic: str
    step: int
    stamp_ns: int
    message: Any


class Rig:
    """Run a learner's controller on a simulated body that does not move by itself.

    Args:
        trial: the trial that the rig belongs to.
        before, after: called before and after `control`, at each step.
        model: the name of the body's model file, without ``.xml``, or the model itself, as MJCF.
        name: the body's name.
        time_step: the duration of a simulation step [s].
        namespace: the node's namespace.
        node: a real node; None for a `MemoryNode`.

    Attributes:
        trial: the trial that the rig belongs to.
        learner: the learner's controller.
        io: the object that the controller's `initialize` receives; it holds the current step.
        displayed, body: the displayed and the simulated body.
        node: the learner's node.
        sent: the published messages.
        begun: the step at which the simulation was last started.
        has_threads: whether any of the learner's threads were running when the simulation was last stopped.

    Raises:
        Failure: one of the learner's methods raised an exception. Every method of a rig can also raise this error.
    """

    def __init__(
        self,
        trial: Trial,
        before: Callable[[], None] = lambda: None,
        after: Callable[[], None] = lambda: None,
        model: str = "tank",
        name: str = "Rover",
        time_step: float = 0.001,
        namespace: str = "/",
        node: Any = None,
    ) -> None:
        self.trial = trial
        self.displayed, self.body = bodies(trial, model, name)
        self.before, self.after, self.sent = before, after, list[Sent]()
        self.io = ControllerIO(self.body, time_step)
        self.node = node or cast("Any", MemoryNode(trial, self._publish, namespace))
        self._thread, self._threads = threading.current_thread(), set(threading.enumerate())
        with trial.calling("__init__"):
            self.learner = trial.answer()
        self.do("configure", ControllerConfig(self.displayed, self.node, _drop, _drop))

    def do(self, method: str, *arguments: Any) -> None:
        """Call one of the learner's methods."""
        with self.trial.calling(method):
            getattr(self.learner, method)(*arguments)

    def start(self, step: int = 0) -> None:
        """Start the simulation at the given step, or restart it after `stop`."""
        self.begun = self.io.step = step
        self.do("initialize", self.io)
        noted = self.trial.noted
        if place := noted.pop("timer", None):
            raise Failure(place.function, Misuse("it makes a timer", APART), place)
        if not has(self.trial.answer, "control") and (place := noted.get("thread")):
            raise Failure(place.function, Misuse("it starts its own thread", APART), place)

    def advance(self, steps: int) -> None:
        """Simulate the given number of steps."""
        check_has(self.trial.answer, "control")
        for _ in range(steps):
            self.before()
            self.do("control")
            self.after()
            self.io.step += 1

    def hear(self, message: Any) -> None:
        """Deliver a message to the callbacks of all subscriptions that receive messages of its type."""
        for callback in self.node.listeners(message):
            self.trial.call(callback, message)

    def stop(self) -> None:
        """Stop the simulation, and wait until the learner's threads have stopped publishing."""
        self.has_threads = bool(set(threading.enumerate()) - self._threads)
        self.do("stop")
        before = -1
        while len(self.sent) > before and set(threading.enumerate()) - self._threads:
            before = len(self.sent)
            time.sleep(QUIET)

    def leave(self) -> str:
        """Call `unconfigure`, check that the controller has left nothing behind, and return "nothing is left"."""
        self.do("unconfigure")
        return str(self.node.check_left())

    def _publish(self, publisher: Endpoint, message: Any) -> None:
        stamp = message.header.stamp if hasattr(message, "header") else Time()
        # nanosec must be less than 10**9. If it is not, its whole seconds are added twice here, so the stamp is wrong.
        stamp_ns = (stamp.sec + stamp.nanosec // 10**9) * 10**9 + stamp.nanosec
        is_here = threading.current_thread() is self._thread
        step = self.io.step if is_here else round(stamp_ns / 1e9 / self.io.time_step)
        self.sent.append(Sent(publisher.topic_name, step, stamp_ns, deepcopy(message)))


def _drop(*_: object) -> None:
    pass
