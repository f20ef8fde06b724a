"""What a controller of a displayed body is tried in: messages on another thread, and the main thread's queue."""

from __future__ import annotations

import asyncio
import inspect
import sys
import threading
from collections.abc import Callable, Hashable
from functools import cache
from pathlib import Path
from typing import Any, Self, cast

import mujoco
import numpy as np

from tutorial.body import Body
from tutorial.checks._answer import name_of
from tutorial.checks._diagnose import Misuse, lacks_self, no_self, slept
from tutorial.checks._rig import MODELS, MemoryNode, Watched, check_has
from tutorial.checks._watch import Failure, watch
from tutorial.controller import ControllerConfig
from tutorial.errors import WrongThreadError
from tutorial.handoff import CallQueue, ThreadGuard
from tutorial.world import Placement, compose

__all__ = ["Viewer"]

TURNS = 1000  # of the loop; many more than there are calls in any check
ASLEEP = 20  # looks, a hundredth of a second each, at a callback that sleeps: it waits, and is not only slow

KEY = "call_latest takes a key first: self.call_latest(self.body.name, self.update, message)."
COROUTINE = (
    "What is posted, or called by a timer, is a plain function, def: to wait in it, it makes a task of the coroutine, "
    "asyncio.create_task(...)."
)
ENDLESS = "Most likely what is posted posts itself: post the method that shows the message, such as self.update."
ARGUMENTS = (
    "Most likely what is posted gets too few arguments, or too many: behind the function come those that it takes, "
    "besides self, as in self.call_later(self.{}, message)."
)


class _Guard(ThreadGuard):
    """A guard that can look away, so that it can be seen how code goes on that it would have stopped.

    Attributes:
        lenient: whether it looks away. `watch` notes who comes by, as ``"touch"``.
    """

    lenient = False

    def check(self, action: str) -> None:
        """Pass on the owner's thread, and whoever comes by while it looks away."""
        try:
            super().check(action)
        except WrongThreadError:
            if not watch.interleaved:
                watch.note("touch", sys._getframe())
                if not self.lenient:
                    raise


class Viewer:
    """A learner's controller on a displayed body. What it posts runs only in `drain`.

    Args:
        answer: the learner's class.
        model: the body's model file, without ``.xml``.
        name: the body's name.
        node: the learner's; None for one in memory.
        namespace: of the node in memory.
        loop: the main thread's; None for one that all such viewers share.

    Attributes:
        node, body, loop: the learner's node, the displayed body, and the loop.
        calls: the main thread's queue. Its length says how many calls wait.
        guard: of the body.
        keys: those of what was posted with `call_latest`.
        uncallable: whether something else than a function was posted.
        shown: what observers of the body saw at each change: where the joints were, and whether the links were there.
        while_drawn: what is called, once, while the body is being drawn.

    Raises:
        Failure: one of the learner's methods raised. So does every method.
    """

    def __init__(
        self,
        answer: type,
        model: str = "tank",
        name: str = "Tank",
        node: Any = None,
        namespace: str = "/",
        loop: asyncio.AbstractEventLoop | None = None,
    ) -> None:
        compiled, self.guard = _model(model, name), _Guard(f"the body {name!r}")
        self._fresh = mujoco.MjData(compiled)
        self.body = Body(name, compiled, mujoco.MjData(compiled), self.guard)
        self.body.calc_forward_kinematics()
        self.body.on_change(self._observe)
        self.node = node or cast("Any", MemoryNode(lambda *_: None, namespace))
        self.loop = loop or _loop()
        self.calls = CallQueue(self.loop)
        self.keys, self.uncallable, self.shown = list[Hashable](), False, list[tuple[str, bool]]()
        self.while_drawn: Callable[[], object] = lambda: None
        self._answer, self._scope = answer, self.calls.scope(name)
        self._failures, self._raised = list[Failure](), list[BaseException]()
        self.learner = Watched(answer)
        post: tuple[Any, Any] = self._later, self._latest
        self.within(self.learner.configure, ControllerConfig(self.body, self.node, *post))

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
        asleep = 0
        while thread.is_alive() and asleep < ASLEEP and "sleep" not in watch.noted:
            thread.join(0.01)
            asleep += thread.is_alive() and _sleeps(thread)
        if thread.is_alive():
            name = name_of(self._callbacks(type(message))[-1])
            raise Failure(name, Misuse("it waits", slept(name)), watch.noted.pop("sleep", None))
        self._tell()

    def call_back(self, message: Any) -> None:
        """Have a message come on this thread."""
        for callback in self._callbacks(type(message)):
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

        self.loop.set_exception_handler(
            lambda _, context: self._raised.append(context.get("exception", RuntimeError(context["message"])))
        )
        self.loop.run_until_complete(turns())
        self._tell()
        if len(self.calls):
            raise Failure(
                "what is posted", Misuse("it posts another call whenever it runs, without end", ENDLESS), None
            )

    def leave(self, *messages: Any) -> None:
        """Have the controller leave its body. What waits does not run any more.

        Args:
            messages: come while the main thread is busy with that, just before.
        """
        check_has(self._answer, "unconfigure", misspelled=True)

        def leave() -> None:
            for message in messages:
                self.receive(message)
            self._scope.close()
            self.learner.unconfigure()

        self.within(leave)

    def listens(self) -> str:
        """Say what it listens to."""
        return ", ".join(f"{each.topic} of {each.kind.__name__}" for each in self.node.subscriptions) or "nothing"

    def where(self) -> str:
        """Say where the joints are [rad or m]."""
        return ", ".join(f"{joint.name} at {round(joint.position, 6) + 0.0:g}" for joint in self.body.joints)

    def links_follow(self) -> bool:
        """Whether the links are where the joints' positions put them."""
        data = self._fresh
        data.qpos[:] = self.body.data.qpos
        mujoco.mj_kinematics(self.body.model, data)
        return bool(np.allclose(data.xquat, self.body.data.xquat) and np.allclose(data.xpos, self.body.data.xpos))

    def run(self, function: Callable[..., object], *arguments: Any) -> None:
        """Run something of the learner's that the main thread calls; what it raises, comes out in the end."""

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

    def _callbacks(self, kind: type) -> list[Any]:
        made = (each for each in self.node.subscriptions if each.kind is kind)
        return [each.callback for each in made if f"/{self.body.name}/" in each.topic]

    def _observe(self, _report: object) -> None:
        self.shown.append((self.where(), self.links_follow()))
        meanwhile, self.while_drawn = self.while_drawn, lambda: None
        meanwhile()

    def _later(self, function: Any, *arguments: Any) -> None:
        if self._can_run(function, arguments):
            self._scope.call_later(self.run, function, *arguments)

    def _latest(self, key: Any, function: Any = None, *arguments: Any) -> None:
        if callable(key) and not callable(function):
            raise Misuse("call_latest is called without a key", KEY)
        self.keys.append(key)
        if self._can_run(function, arguments):
            self._scope.call_latest(key, self.run, function, *arguments)

    def _can_run(self, function: Any, arguments: tuple[Any, ...]) -> bool:
        if not callable(function):
            self.uncallable = True
            return False
        try:
            inspect.signature(function).bind(*arguments)
        except TypeError as error:
            inner = getattr(function, "__func__", None)
            cause = ARGUMENTS.format(name_of(function))
            if inner is not None and lacks_self(inner):
                cause = no_self(inner)
            count = f"{len(arguments)} argument{'s' * (len(arguments) != 1)}"
            raise Misuse(f"{name_of(function)} is posted with {count}, it cannot begin: {error}", cause) from error
        return True

    def _tell(self) -> None:
        """Raise what the learner's code has raised meanwhile."""
        if self._failures:
            raise self._failures.pop(0)
        if self._raised:
            with watch.call("what runs on the loop"):
                raise self._raised.pop(0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.calls.close()


@cache
def _loop() -> asyncio.AbstractEventLoop:
    return asyncio.new_event_loop()


@cache
def _model(model: str, name: str) -> mujoco.MjModel:
    return compose([Placement(name, MODELS / f"{model}.xml")])


def _sleeps(thread: threading.Thread) -> bool:
    """Whether a thread of this process waits for something, rather than for the processor; where Linux tells."""
    stat = Path(f"/proc/self/task/{thread.native_id}/stat")
    try:
        return stat.read_text().rpartition(")")[2].split()[0] == "S"
    except OSError:
        return True
