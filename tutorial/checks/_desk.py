"""A displayed body with the learner's controller, the main thread's event loop, and messages that arrive."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Hashable, Sequence
from typing import Any

import mujoco
import numpy as np
from sensor_msgs.msg import JointState

from tutorial.body import Body
from tutorial.checks._watch import Failure, watch
from tutorial.checks._world import MODELS, Stage, Watched
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.handoff import CallQueue, ThreadGuard
from tutorial.world import Placement

__all__ = ["Desk", "joint_state"]


class _Witness(ThreadGuard):
    """A guard that can look away, to see how code would go on that it has stopped.

    Attributes:
        lenient: whether it does.
    """

    lenient = False

    def check(self, action: str) -> None:
        """Pass on the owner's thread, and whoever comes by while it looks away."""
        if not self.lenient:
            super().check(action)


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
        last_call: the call that was posted last.
    """

    def __init__(self, controller_class: type[SimpleController], model: str, name: str) -> None:
        self.guard = _Witness(f"the body {name!r}")
        self.body = Body.displayed(Placement(name, MODELS / f"{model}.xml"), self.guard)
        self.body.on_change(lambda _: self.shown.append((self.positions(), self.links_follow())))
        self.learner = Watched(controller_class)
        self.keys: list[Hashable] = []
        self.uncallable = self.keyless = False
        self.shown: list[tuple[tuple[float, ...], bool]] = []
        self.last_call: Callable[[], None] = lambda: None
        self._failures: list[Failure] = []
        self._loop = asyncio.new_event_loop()
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
            while len(self._calls):
                await asyncio.sleep(0)

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
            try:
                with watch.call(getattr(function, "__name__", "the posted call")):
                    function(*args)
            except Failure as failure:
                self._failures.append(failure)

        self.last_call = run
        post(run)


def joint_state(names: Sequence[str], positions: Sequence[float], milliseconds: int = 0) -> JointState:
    """Make a message, with a stamp in milliseconds."""
    message = JointState(name=list(names), position=list(positions))
    message.header.stamp.sec, rest = divmod(milliseconds, 1000)
    message.header.stamp.nanosec = rest * 1_000_000
    return message
