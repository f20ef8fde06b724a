"""A displayed body with the learner's controller, the main thread's event loop, and messages that arrive."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable, Hashable, Sequence
from typing import Any

import mujoco
import numpy as np
from sensor_msgs.msg import JointState

from tutorial.body import Body
from tutorial.checks._answer import name_of
from tutorial.checks._diagnose import Misuse, blamed
from tutorial.checks._verdict import Place
from tutorial.checks._watch import Failure, watch
from tutorial.checks._world import MODELS, Stage, Watched
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.errors import WrongThreadError
from tutorial.handoff import CallQueue, ThreadGuard
from tutorial.world import Placement

__all__ = ["Desk", "joint_state"]


TURNS = 1000  # of the loop; many more than there are calls in any check

ENDLESS = "Most likely the callback posts itself: post the method that shows the message, such as self.update."
ARGUMENTS = (
    "Most likely what is posted gets too few arguments, or too many: behind the function come those that it takes, "
    "besides self, as in self.call_later(self.{name}, message)."
)


class _Witness(ThreadGuard):
    """A guard that can look away, and notes what it has seen, to tell how code goes on that it would have stopped.

    Attributes:
        lenient: whether it looks away.
        touched: whether somebody came by while it did.
        place: the learner's line that came by first, where it was one.
    """

    lenient = False
    touched = False
    place: Place | None = None

    def check(self, action: str) -> None:
        """Pass on the owner's thread, and whoever comes by while it looks away."""
        try:
            super().check(action)
        except WrongThreadError:
            if not self.lenient:
                raise
            self.touched, self.place = True, self.place or watch.place(sys._getframe())


class Desk(Stage):
    """One displayed body on the main thread, and the learner's controller. Posted calls run only in `drain`.

    Args:
        controller_class: the learner's class.
        model: the body's model file, without ``.xml``.
        name: the body's name.

    Attributes:
        body: the displayed body.
        guard: the body's.
        keys: the keys of what was posted with `call_latest`.
        uncallable: whether something else than a function was posted.
        keyless: whether `call_latest` was called without a key.
        shown: what observers of the body saw at each change: the positions, and whether the links were there.
        while_drawn: what is called, once, by an observer of the body, while it is being drawn; None for nothing.
    """

    make_loop: Callable[[], asyncio.AbstractEventLoop] = staticmethod(asyncio.new_event_loop)

    def __init__(self, controller_class: type[SimpleController], model: str, name: str) -> None:
        self.guard = _Witness(f"the body {name!r}")
        self.body = Body.displayed(Placement(name, MODELS / f"{model}.xml"), self.guard)
        self.body.on_change(self._observe)
        self.learner = Watched(controller_class)
        self.keys: list[Hashable] = []
        self.uncallable = self.keyless = False
        self.shown: list[tuple[tuple[float, ...], bool]] = []
        self.while_drawn: Callable[[], object] | None = None
        self._posted = ""
        self._failures: list[Failure] = []
        self._loop = self.make_loop()
        self._calls = CallQueue(self._loop)
        self._scope = self._calls.scope(name)

    def config(self) -> ControllerConfig:
        """Return what the controller is given."""
        return ControllerConfig(self.body, self.ros.node, self._call_later, self._call_latest)

    def close(self) -> None:
        """End the nodes, and what was posted and has not run."""
        self._calls.close()
        self._loop.close()
        super().close()

    @property
    def waiting(self) -> int:
        """How many posted calls wait for the main thread."""
        return len(self._calls)

    def drain(self) -> None:
        """Run what was posted.

        Raises:
            Failure: one of the calls raised.
        """

        async def turns() -> None:
            for _ in range(TURNS):
                if not len(self._calls):
                    return
                await asyncio.sleep(0)
            raise Failure(self._posted, Misuse("whenever it runs, it posts another call, without end", ENDLESS), None)

        self._loop.run_until_complete(turns())
        if self._failures:
            raise self._failures.pop(0)

    def positions(self) -> tuple[float, ...]:
        """Return where the joints are [rad or m], rounded."""
        return tuple(round(joint.position, 6) for joint in self.body.joints)

    def links_follow(self) -> bool:
        """Whether the links are where the joints' positions put them."""
        data = mujoco.MjData(self.body.model)
        data.qpos[:] = self.body.data.qpos
        mujoco.mj_kinematics(self.body.model, data)
        return bool(np.allclose(data.xquat, self.body.data.xquat) and np.allclose(data.xpos, self.body.data.xpos))

    def _observe(self, _report: object) -> None:
        self.shown.append((self.positions(), self.links_follow()))
        meanwhile, self.while_drawn = self.while_drawn, None
        if meanwhile is not None:
            meanwhile()

    def _call_later(self, function: Callable[..., object], *args: object) -> None:
        self._post(self._scope.call_later, function, args)

    def _call_latest(self, key: Hashable, function: Any = None, *args: object) -> None:
        if callable(key) and not callable(function):
            self.keyless = True
            return
        self.keys.append(key)
        self._post(lambda *call: self._scope.call_latest(key, *call), function, args)

    def _post(self, post: Callable[..., None], function: Any, args: tuple[object, ...]) -> None:
        if not callable(function):
            self.uncallable = True
            return

        def run() -> None:
            self._posted = name_of(function)
            try:
                with watch.call(self._posted):
                    function(*args)
            except Failure as failure:
                self._failures.append(_of_arguments(failure, len(args)))

        post(run)


def _of_arguments(failure: Failure, given: int) -> Failure:
    """Say of a posted call that could not even begin that its arguments are wrong; else return the failure itself."""
    error = failure.error
    if failure.place is not None or not isinstance(error, TypeError) or blamed(error, watch.answer) is not None:
        return failure
    text = f"posted with {given} argument{'s' * (given != 1)}, it cannot begin: {error}"
    return Failure(failure.method, Misuse(text, ARGUMENTS.format(name=failure.method)), None)


def joint_state(names: Sequence[str], positions: Sequence[float], milliseconds: int = 0) -> JointState:
    """Make a message, with a stamp in milliseconds."""
    message = JointState(name=list(names), position=list(positions))
    message.header.stamp.sec, rest = divmod(milliseconds, 1000)
    message.header.stamp.nanosec = rest * 1_000_000
    return message
