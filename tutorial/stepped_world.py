"""The simulated copy of the world, stepped together with its controllers: no thread of its own, no lock."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import mujoco

from tutorial.body import Body, FindCamera
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError, file_of, tell
from tutorial.handoff import Latest
from tutorial.world import Placement, compose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LOOK_EVERY = 0.001  # [s] while a run is watched
_log = logging.getLogger(__name__)


class ControllerError(TutorialError):
    """A controller raised, or does not return; the simulation has stopped. What was raised is the cause of this one."""


@dataclass(frozen=True)
class Snapshot:
    """The state of the whole simulated world at one moment, as a copy.

    Attributes:
        time: simulated time [s].
        qpos: MuJoCo's generalised positions, shape (nq,).
    """

    time: float
    qpos: NDArray[np.float64]


@dataclass(eq=False)
class Run:
    """One thread's work with the controllers of a world. Any thread may look at it, or ask it to end.

    Attributes:
        thread: the thread.
        is_own: whether the thread was made for the run, and ends with it.
        controller: the controller that is at work, or was last; None while MuJoCo is.
        laps: grows after each step, when no controller is at work.
        stopping: set to ask the run to end.
        finished: set when it has ended, or was abandoned.
        abandoned: nobody waits for it any more, and it may not touch the world any more.
    """

    thread: threading.Thread
    is_own: bool = False
    controller: SimpleController | None = None
    laps: int = 0
    stopping: threading.Event = field(default_factory=threading.Event)
    finished: threading.Event = field(default_factory=threading.Event)
    abandoned: bool = False

    def is_mine(self) -> bool:
        """Whether the calling thread is this run's, which has not ended: then a controller calls."""
        return self.thread is threading.current_thread() and not self.finished.is_set()

    def wait_for_lap(self, seconds: float) -> bool:
        """Wait until the run has come to its next lap, or to its end; False when it does neither in so many seconds."""
        before, deadline = self.laps, time.monotonic() + seconds
        while self.laps == before and not self.finished.wait(LOOK_EVERY):
            if time.monotonic() > deadline:
                return False
        return True

    def abandon(self) -> None:
        """Mark it as abandoned and finished, and ask it to end."""
        self.abandoned = True
        self.stopping.set()
        self.finished.set()

    def at_work(self) -> tuple[str, str]:
        """Return the name of the controller's class, and the file that it is written in."""
        kind = type(self.controller)
        return ("MuJoCo", "") if self.controller is None else (kind.__name__, file_of(kind))


class SteppedWorld:
    """Some bodies in one MuJoCo world, and the controllers that move them. One thread at a time may step it.

    Args:
        placements: the bodies.
        controllers: pairs of a body's name ("" for the world) and a controller, in the order in which they are asked.
        time_step: [s].
        find_camera: what finds a camera of a simulated body, see `Body`; None for a world without pictures.

    Attributes:
        model: the composed MuJoCo model.
        data: its state; it belongs to the thread that steps.
        time_step: as given.
        bodies: the simulated bodies by name.
        step: how many steps have been simulated since the start.
        snapshot: the newest state to be shown.

    Raises:
        TutorialError: the bodies do not make a world.
    """

    def __init__(
        self,
        placements: Sequence[Placement],
        controllers: Iterable[tuple[str, SimpleController]] = (),
        time_step: float = 0.001,
        find_camera: FindCamera | None = None,
    ) -> None:
        self.model = compose(placements, time_step)
        self.data = mujoco.MjData(self.model)
        self.time_step = time_step
        self.bodies = {p.name: Body(p.name, self.model, self.data, find_camera=find_camera) for p in placements}
        places = self.bodies | {"": Body("", self.model, self.data)}
        self._controllers = [(each, ControllerIO(places[name], time_step)) for name, each in controllers]
        self._initialized = False
        self.step = 0
        self.snapshot = Latest(self._snap())

    @property
    def time(self) -> float:
        """Simulated time since the start [s]."""
        return self.step * self.time_step

    def copy_to(self, bodies: Iterable[Body]) -> float:
        """Move displayed bodies to where the newest snapshot has them. Main thread.

        Args:
            bodies: displayed bodies; those that are not simulated stay as they are.

        Returns:
            The simulated time that they show now [s].
        """
        snapshot = self.snapshot.get()
        for body in bodies:
            simulated = self.bodies.get(body.name)
            if simulated is not None and len(body.qpos):
                body.qpos[:] = snapshot.qpos[simulated.qpos_slice]
                body.calc_forward_kinematics()
                body.notify_change()
        return snapshot.time

    def _initialize(self, run: Run) -> None:
        """Initialize every controller, once until they are stopped. If one fails, stop those that are ready."""
        if self._initialized:
            return
        mujoco.mj_forward(self.model, self.data)
        ready: list[SimpleController] = []
        try:
            for controller, io in self._controllers:
                run.controller, io.step = controller, self.step
                controller.initialize(io)
                if run.abandoned:
                    return
                ready.append(controller)
        except BaseException as error:
            failed = self._controller_error(run, error)
            self._stop_each(run, ready)
            raise failed from error
        run.controller = None
        self._initialized = True

    def _run_steps(self, run: Run, count: int) -> bool:
        """Ask every controller and let MuJoCo step, so many times. False if the run is to end before."""
        model, data, mj_step = self.model, self.data, mujoco.mj_step
        run.laps += 1
        try:
            for _ in range(count):
                if run.stopping.is_set():
                    return False
                for controller, io in self._controllers:
                    run.controller, io.step = controller, self.step
                    controller.control()
                    if run.abandoned:
                        return False
                run.controller = None
                mj_step(model, data)
                self.step += 1
                run.laps += 1
        except BaseException as error:
            if run.controller is None and not isinstance(error, Exception):
                raise  # the reader's Ctrl-C, between two controllers
            raise self._controller_error(run, error) from error
        return True

    def _stop_each(self, run: Run, controllers: Iterable[SimpleController]) -> ControllerError | None:
        """Stop one controller after the other. One that fails is logged, and holds up none of the others.

        Returns:
            What the last of them that failed raised.
        """
        failed = None
        for controller in controllers:
            run.controller = controller
            try:
                controller.stop()
            except BaseException as error:  # noqa: BLE001 - whatever it is, the others still have to stop
                failed = self._controller_error(run, error)
                _log.error("%s", failed, exc_info=error)
            if run.abandoned:
                break
        return failed

    def _controller_error(self, run: Run, error: BaseException) -> ControllerError:
        """Say which controller failed, when, and in which line."""
        name, file = run.at_work()
        return ControllerError(f"{name} failed at {self.time:.3f} s of simulated time: {tell(error, file)}")

    def _snap(self) -> Snapshot:
        return Snapshot(self.time, self.data.qpos.copy())
