"""A viewer: a learner's controller on a displayed body. Messages arrive on another thread; posted calls are queued."""

import inspect
import sys
import threading
from collections.abc import Callable, Hashable, Mapping
from functools import partial
from numbers import Real
from typing import Any, Self, cast

import mujoco
import numpy as np

from tutorial.checks.engine.answer import name_of
from tutorial.checks.engine.bodies import displayed_body, scratch
from tutorial.checks.engine.clock import ClockedLoop
from tutorial.checks.engine.exceptions import slept
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.memory_node import MemoryNode
from tutorial.checks.engine.trial import Trial
from tutorial.controller import ControllerConfig
from tutorial.handoff import CallQueue, ThreadGuard

TIMEOUT = 1.0  # [s]; a callback that takes longer is waiting for something

KEY = "The first argument of call_latest is a key: self.call_latest(self.body.name, self.update, message)."
SECONDS = (
    "config.call_later has no delay argument. The event loop's call_later has one: "
    "asyncio.get_running_loop().call_later(0.5, self.land)."
)
PARENTHESES = (
    "Your code probably calls the function immediately, with parentheses. Pass the function, then its arguments."
)
TOUCHED = "Your code probably moves the body in the callback. Post every call that uses the body; a lock does not help."
COROUTINE = "Write def, not async def. If the function has to wait, start a task in it: asyncio.create_task(...)."
ENDLESS = "The posted call probably posts itself again. Post the method that shows the message, such as self.update."


class _Guard(ThreadGuard):
    """A guard that raises no exceptions, but records ``"touch"`` if a thread other than the main thread uses the body.

    This way, the check also sees what the code does next, such as posting a method's return value.
    """

    def __init__(self, name: str, trial: Trial) -> None:
        super().__init__(name)
        self._trial = trial

    def check(self, _action: str) -> None:
        """Record a call from a thread other than the main thread."""
        if threading.get_ident() != self._ident and not self._trial.is_interleaved:
            self._trial.note("touch", sys._getframe())


class Viewer:
    """Run a learner's controller on a displayed body. Posted calls run only in `drain`, on a simulated clock.

    Args:
        trial: the trial that the viewer belongs to.
        model: the name of the body's model file, without ``.xml``.
        name: the body's name.
        node: a real node; None for a `MemoryNode`.

    Attributes:
        trial: the trial that the viewer belongs to.
        node, body, loop: the learner's node, the displayed body, and the main thread's event loop.
        calls: the main thread's queue. Its length is the number of waiting calls.
        keys: the keys of the calls that were posted with `call_latest`.
        shown: what the observers saw at each change, as pairs: the body's position, and whether its links were already
            up to date.

    Raises:
        Failure: one of the learner's methods raised an exception. Every method of a viewer can also raise this error.
    """

    def __init__(self, trial: Trial, model: str = "tank", name: str = "Rover", node: Any = None) -> None:
        self.trial, self._fresh = trial, scratch(trial, model, name)
        self.body = displayed_body(trial, model, name, _Guard(f"the body {name!r}", trial))
        self.body.calc_forward_kinematics()
        self.body.on_change(lambda _: self.shown.append((self.where(), self._links_follow())))
        self.node = node or cast("Any", MemoryNode(trial))
        self.loop = ClockedLoop(trial)
        self.loop.wrap = lambda function: partial(self._run, function)
        self.loop.set_exception_handler(self._failed)
        self.calls = CallQueue(self.loop)
        self.keys, self.shown = list[Hashable](), list[tuple[str, bool]]()
        self._scope, self._failures = self.calls.scope(name), list[Failure]()
        post: tuple[Any, Any] = self._later, self._latest
        try:
            with trial.calling("__init__"):
                self._learner = trial.answer()
            self.loop.call_soon(self._run, self._learner.configure, ControllerConfig(self.body, self.node, *post))
            self.drain()
        except Failure:
            self.close()
            raise

    def another(self, model: str = "tank", name: str = "Rover") -> Self:
        """Make another viewer for the same answer."""
        return type(self)(self.trial, model, name)

    def receive(self, message: Any) -> None:
        """Deliver a message on a separate thread, and wait until the callbacks have returned."""
        thread = threading.Thread(target=self.call_back, args=(message,), daemon=True)
        thread.start()
        thread.join(TIMEOUT)
        if thread.is_alive():
            name = self.trial.running[thread.ident or 0][-1].method
            raise Failure(name, Misuse("it waits", slept(name)), self.trial.noted.pop("sleep", None))
        self._tell()

    def call_back(self, message: Any) -> None:
        """Deliver a message on the calling thread."""
        for callback in self.node.listeners(message):
            self._run(callback, message)

    def drain(self, seconds: float = 0.0) -> None:
        """Let the given time [s] pass, and run the posted calls."""
        self.loop.advance(seconds)
        self._tell()
        if len(self.calls) and not self.trial.is_interleaved:  # in an interleaved case, the other thread can post late
            raise Failure("the posted call", Misuse("every time it runs, it posts another call", ENDLESS))

    def leaves(self, *messages: Any) -> str:
        """Call `unconfigure`, drop the waiting calls, and describe where the body is afterwards.

        Args:
            messages: messages that arrive just before `unconfigure` is called, while the main thread is blocked.
        """
        self.shown.clear()

        def leave() -> None:
            for message in messages:
                self.receive(message)
            self._scope.close()
            self._run(self._learner.unconfigure)

        self.loop.call_soon(leave)
        self.drain()
        return "a timer is still running" if self.loop.timers else self.where()

    def left(self) -> str:
        """Check that the controller has left nothing behind on the node, and return "nothing is left"."""
        return str(self.node.check_left())

    def where(self) -> str:
        """Describe the joints' positions [rad or m]."""
        return ", ".join(f"{joint.name} at {round(joint.position, 6) + 0.0:g}" for joint in self.body.joints)

    def news(self) -> str:
        """Report whether the links followed the last move, and whether observers were notified."""
        told = f"observers are notified{' too early' * (self.shown[-1] != (self.where(), True))}" if self.shown else ""
        return f"its links {'follow' if self._links_follow() else 'stay behind'}, {told or 'nobody is notified'}"

    def close(self) -> None:
        """Drop the waiting calls, and close the loop."""
        self.calls.close()
        self.loop.close()

    def _links_follow(self) -> bool:
        """Return whether the links' poses match the joints' positions."""
        self._fresh.qpos[:] = self.body.data.qpos
        mujoco.mj_kinematics(self.body.model, self._fresh)
        return all(np.allclose(getattr(self._fresh, name), getattr(self.body.data, name)) for name in ("xpos", "xquat"))

    def _run(self, function: Callable[..., object], *arguments: Any) -> None:
        """Call one of the learner's functions, and store any failure that it raises."""
        try:
            with self.trial.calling(name_of(function)):
                made = function(*arguments)
                if inspect.iscoroutine(made):
                    made.close()
                    raise Misuse("it is defined with async def, and nobody awaits it", COROUTINE)
        except Failure as failure:
            self._failures.append(failure)

    def _failed(self, _loop: object, context: Mapping[str, Any]) -> None:
        """Store an error that asyncio reports for code running on the loop."""
        error = context.get("exception") or RuntimeError(context["message"])
        if not isinstance(error, Failure):
            error = self.trial.failure("code on the loop", error)
        self._failures.append(error)

    def _later(self, function: Any, *arguments: Any) -> None:
        _check_callable(function)
        self._scope.call_later(self._run, function, *arguments)

    def _latest(self, key: Any, function: Any = None, *arguments: Any) -> None:
        if callable(key) and not callable(function):
            raise Misuse("call_latest is called without a key", KEY)
        self.keys.append(key)
        _check_callable(function)
        self._scope.call_latest(key, self._run, function, *arguments)

    def _tell(self) -> None:
        """Raise the first stored failure, or a new one if the learner's code used the body on a different thread."""
        failures, self._failures = self._failures, []
        noted = self.trial.noted
        for failure in failures[:1]:
            if "touch" not in noted or failure.is_misuse:
                raise failure
        if "touch" in noted:
            raise Failure("the callback", Misuse("it uses the body outside the main thread", TOUCHED), noted["touch"])


def _check_callable(function: Any) -> None:
    """Reject an object that is not callable.

    Raises:
        Misuse: the object is not callable.
    """
    if not callable(function):
        cause = SECONDS if isinstance(function, Real) else PARENTHESES
        raise Misuse(f"it posts something that cannot be called: {function!r:.40}", cause)
