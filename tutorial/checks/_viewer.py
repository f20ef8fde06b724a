"""What a controller of a displayed body is tried in: messages on another thread, and the main thread's queue."""

from __future__ import annotations

import asyncio
import inspect
import sys
import threading
from collections.abc import Callable, Hashable, Mapping
from functools import cache, partial
from numbers import Real
from typing import Any, Self, cast

import mujoco
import numpy as np

from tutorial.body import Body
from tutorial.checks._answer import name_of
from tutorial.checks._clock import ClockedLoop
from tutorial.checks._diagnose import Misuse, lacks_self, no_self, slept
from tutorial.checks._node import ros_node, send
from tutorial.checks._rig import MODELS, MemoryNode, Watched, check_has
from tutorial.checks._watch import Failure, watch
from tutorial.controller import ControllerConfig
from tutorial.errors import WrongThreadError
from tutorial.handoff import CallQueue, ThreadGuard
from tutorial.world import Placement, compose

__all__ = ["LISTENS", "POSTS", "TOLD", "Attempt", "Viewer", "hands_over", "heard", "over_ros"]

Attempt = Callable[[type], str]
Step = Callable[[Any], str | None]

TURNS = 1000  # of the loop; many more than there are calls in any check
LOOKS = 100  # a hundredth of a second each, after which a callback that has not returned waits for something

LISTENS = "on a body called Rover it listens to"
POSTS = "the callback posts, and leaves the body alone"
TOLD = "its links follow, observers are told"

KEY = "call_latest takes a key first: self.call_latest(self.body.name, self.update, message)."
SECONDS = "config.call_later takes no seconds: the loop's does, asyncio.get_running_loop().call_later(0.5, self.land)."
PARENTHESES = "Most likely the parentheses call it at once: give the function itself first, then its arguments."
TOUCHED = "Most likely the callback moves the body itself: post all that touches it; a lock does not help."
BESIDE = "Most likely a timer or a thread of its own posts: the callback itself posts, once for each message."
COROUTINE = "It has to be a plain function, def: to wait, it makes a task of a coroutine, asyncio.create_task(...)."
ENDLESS = "Most likely what is posted posts itself: post the method that shows the message, such as self.update."
ARGUMENTS = "Most likely what is posted gets too few arguments, or too many: those of {} follow it, but not self."


class _Guard(ThreadGuard):
    """A guard that stops nobody: it has `watch` note who comes by on another thread than the main one, ``"touch"``.

    So a check sees what such code does next, for example that it posts what a method has returned.
    """

    def check(self, action: str) -> None:
        """Note whoever comes by on another thread."""
        try:
            super().check(action)
        except WrongThreadError:
            if not watch.interleaved:
                watch.note("touch", sys._getframe())


class Viewer:
    """A learner's controller on a displayed body. What it posts runs only in `drain`, and the clock stands still.

    Args:
        answer: the learner's class.
        model: the body's model file, without ``.xml``.
        name: the body's name.
        node: the learner's; None for one in memory.

    Attributes:
        node, body, loop: the learner's node, the displayed body, and the main thread's loop.
        calls: the main thread's queue. Its length says how many calls wait.
        keys: those of what was posted with `call_latest`.
        shown: what observers of the body saw at each change: where it was, and whether the links were there.
        while_drawn: what is called, once, while the body is being drawn.

    Raises:
        Failure: one of the learner's methods raised. So does every method.
    """

    def __init__(self, answer: type, model: str = "tank", name: str = "Rover", node: Any = None) -> None:
        compiled = _model(model, name)
        self._fresh = mujoco.MjData(compiled)
        self.body = Body(name, compiled, mujoco.MjData(compiled), _Guard(f"the body {name!r}"))
        self.body.calc_forward_kinematics()
        self.body.on_change(self._observe)
        self.node = node or cast("Any", MemoryNode(lambda *_: None))
        self.loop = ClockedLoop()
        self.loop.wrap = lambda function: partial(self._run, function)
        self.loop.set_exception_handler(lambda _, context: self._keep(_raise, context))
        self.calls = CallQueue(self.loop)
        self.keys, self.shown = list[Hashable](), list[tuple[str, bool]]()
        self.while_drawn: Callable[[], object] = lambda: None
        self._answer, self._scope, self._failures = answer, self.calls.scope(name), list[Failure]()
        try:
            self.learner = Watched(answer)
            post: tuple[Any, Any] = self._later, self._latest
            self.within(self.learner.configure, ControllerConfig(self.body, self.node, *post))
        except Failure:
            self.loop.close()
            raise

    @classmethod
    def tries(cls, *steps: Step) -> Attempt:
        """Make an attempt of steps, functions of the viewer, each of which may say what is seen."""

        def attempt(answer: type) -> str:
            with cls(answer) as viewer:
                return ", ".join(filter(None, [step(viewer) for step in steps]))

        return attempt

    def within(self, function: Callable[..., object], *arguments: Any) -> None:
        """Call a function as a cell of a notebook does: on the main thread, while its loop is running."""

        async def call() -> None:
            self._keep(function, *arguments)

        self.loop.run_until_complete(call())
        self._tell()

    def receive(self, message: Any) -> None:
        """Have a message come, on a thread of its own, and wait until the callbacks have returned."""
        thread = threading.Thread(target=self._keep, args=(self.call_back, message), daemon=True)
        thread.start()
        looks = 0
        while thread.is_alive() and looks < LOOKS and "sleep" not in watch.noted:
            thread.join(0.01)
            looks += 1
        if thread.is_alive():
            name = name_of(self._callbacks(message)[-1])
            raise Failure(name, Misuse("it waits", slept(name)), watch.noted.pop("sleep", None))
        self._tell()

    def call_back(self, message: Any) -> None:
        """Have a message come on this thread."""
        for callback in self._callbacks(message):
            with watch.call(name_of(callback)):
                callback(message)

    def drain(self) -> None:
        """Run what was posted."""

        async def turns() -> None:
            for _ in range(TURNS):
                await asyncio.sleep(0)
                if not len(self.calls):
                    break
            await asyncio.sleep(0)

        self.loop.run_until_complete(turns())
        self._tell()
        if len(self.calls):
            raise Failure(
                "what is posted", Misuse("it posts another call whenever it runs, without end", ENDLESS), None
            )

    def leaves(self, *messages: Any) -> str:
        """Have the controller leave its body, and say where the body is then. What waits does not run any more.

        Args:
            messages: come while the main thread is busy with that, just before.
        """
        check_has(self._answer, "unconfigure", misspelled=True)
        self.shown.clear()

        def leave() -> None:
            for message in messages:
                self.receive(message)
            self._scope.close()
            self.learner.unconfigure()

        self.within(leave)
        self.drain()
        return "a timer goes on" if self.loop.timers else self.where()

    def left(self) -> str:
        """Say that the controller has left nothing behind at the node."""
        return str(self.node.check_left())

    def listens(self) -> str:
        """Say what it listens to."""
        return ", ".join(f"{each.topic} of {each.kind.__name__}" for each in self.node.subscriptions) or "nothing"

    def where(self) -> str:
        """Say where the joints are [rad or m]."""
        return ", ".join(f"{joint.name} at {round(joint.position, 6) + 0.0:g}" for joint in self.body.joints)

    def news(self) -> str:
        """Say whether everything follows the last move."""
        told = f"observers are told{' too early' * (self.shown[-1] != (self.where(), True))}" if self.shown else ""
        return f"its links {'follow' if self._links_follow() else 'stay behind'}, {told or 'nobody is told'}"

    def _links_follow(self) -> bool:
        """Whether the links are where the joints' positions put them."""
        data = self._fresh
        data.qpos[:] = self.body.data.qpos
        mujoco.mj_kinematics(self.body.model, data)
        return bool(np.allclose(data.xquat, self.body.data.xquat) and np.allclose(data.xpos, self.body.data.xpos))

    def _run(self, function: Callable[..., object], *arguments: Any) -> None:
        """Call a function of the learner's, as the main thread does, and keep the failure that it raises."""

        def call() -> None:
            with watch.call(name_of(function)):
                made = function(*arguments)
                if inspect.iscoroutine(made):
                    made.close()
                    raise Misuse("it is a coroutine function, async def, and nobody awaits it", COROUTINE)

        self._keep(call)

    def _keep(self, function: Callable[..., object], *arguments: Any) -> None:
        """Call a function, and keep the failure that it raises."""
        try:
            function(*arguments)
        except Failure as failure:
            self._failures.append(failure)

    def _callbacks(self, message: Any) -> list[Any]:
        return [each.callback for each in self.node.subscriptions if each.kind is type(message)]

    def _observe(self, _report: object) -> None:
        self.shown.append((self.where(), self._links_follow()))
        meanwhile, self.while_drawn = self.while_drawn, lambda: None
        meanwhile()

    def _later(self, function: Any, *arguments: Any) -> None:
        _check_call(function, arguments)
        self._scope.call_later(self._run, function, *arguments)

    def _latest(self, key: Any, function: Any = None, *arguments: Any) -> None:
        if callable(key) and not callable(function):
            raise Misuse("call_latest is called without a key", KEY)
        self.keys.append(key)
        _check_call(function, arguments)
        self._scope.call_latest(key, self._run, function, *arguments)

    def _tell(self) -> None:
        """Raise what the learner's code has raised meanwhile, or say that it has touched the body on another thread."""
        failures, self._failures = self._failures, []
        for failure in failures[:1]:
            if "touch" not in watch.noted or isinstance(failure.error, Misuse):
                raise failure
        if "touch" in watch.noted:
            name = name_of(self.node.subscriptions[-1].callback)
            raise Failure(name, Misuse("the body is touched on another thread", TOUCHED), watch.noted["touch"])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.calls.close()
        self.loop.close()


def heard(*messages: Any) -> Step:
    """Make a step: messages come one after the other, and what each has posted runs."""

    def step(viewer: Viewer) -> None:
        for message in messages:
            viewer.receive(message)
            viewer.drain()

    return step


def hands_over(least: int, *messages: Any) -> Step:
    """Make a step: say whether the callback leaves the body alone, and posts at least so many of the messages."""

    def step(viewer: Viewer) -> str:
        for message in messages:
            viewer.receive(message)
            if "thread" in watch.noted or viewer.node.timers:
                where = watch.noted.get("thread")
                raise Failure("the callback", Misuse("a timer or a thread goes on beside it", BESIDE), where)
            viewer.drain()
        posted = viewer.loop.posted
        return POSTS if posted >= least else "some messages are not posted" if posted else "nothing is posted"

    return step


def over_ros(viewers: type[Viewer], topic: str, message: Any) -> Attempt:
    """Make an attempt with rclpy's own node: say where the body is after a message from another node."""

    def attempt(answer: type) -> str:
        with ros_node() as node, viewers(answer, node=node) as viewer:
            send(node, topic, message, lambda: viewer.loop.posted)
            viewer.drain()
            return viewer.where()

    return attempt


def _check_call(function: Any, arguments: tuple[Any, ...]) -> None:
    """Refuse to post what cannot be called, or not with these arguments.

    Raises:
        Misuse: it cannot.
    """
    if not callable(function):
        cause = SECONDS if isinstance(function, Real) else PARENTHESES
        raise Misuse(f"what is posted is no function: {function!r:.40}", cause)
    try:
        inspect.signature(function).bind(*arguments)
    except TypeError as error:
        inner = getattr(function, "__func__", None)
        cause = no_self(inner) if inner is not None and lacks_self(inner) else ARGUMENTS.format(name_of(function))
        count = f"{len(arguments)} argument{'s' * (len(arguments) != 1)}"
        raise Misuse(f"{name_of(function)} is posted with {count}, it cannot begin: {error}", cause) from error


def _raise(context: Mapping[str, Any]) -> None:
    """Raise what asyncio says of something that runs on the loop."""
    with watch.call("what runs on the loop"):
        raise context.get("exception") or RuntimeError(context["message"])


@cache
def _model(model: str, name: str) -> mujoco.MjModel:
    return compose([Placement(name, MODELS / f"{model}.xml")])
