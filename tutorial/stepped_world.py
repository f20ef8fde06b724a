"""A MuJoCo world that is stepped together with its controllers. It has no thread or lock of its own."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.body import Body, FindCamera
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError, describe_error, file_of
from tutorial.handoff import RequestQueue
from tutorial.world import Placement, compose

POLL_EVERY = 0.001  # [s] between checks for a run's next lap
_log = logging.getLogger(__name__)


class ControllerError(TutorialError):
    """The simulation has stopped because a controller raised an exception (this error's cause) or did not return."""


@dataclass(frozen=True)
class Snapshot:
    """A copy of the state of the whole simulated world.

    Attributes:
        time: simulated time [s].
        qpos: MuJoCo's generalized positions, shape (nq,).
    """

    time: float
    qpos: NDArray[np.float64]


@dataclass(eq=False)
class Run:
    """The work of one thread that calls controllers. Other threads watch it, and can ask it to end.

    Attributes:
        thread: the thread.
        is_own: whether the thread was created for the run, and ends with it.
        controller: the controller that was called last and may still be running; None while MuJoCo steps.
        laps: a counter that is incremented between steps, when no controller is running.
        stopping: set to ask the run to end.
        finished: set when the run has ended or has been abandoned.
        abandoned: whether another thread has given up on the run. An abandoned run must no longer touch the world.
    """

    thread: threading.Thread
    is_own: bool = False
    controller: SimpleController | None = None
    laps: int = 0
    stopping: threading.Event = field(default_factory=threading.Event)
    finished: threading.Event = field(default_factory=threading.Event)
    abandoned: bool = False

    @classmethod
    def on_own_thread(cls, main: Callable[[Run], object]) -> Run:
        """Make a run with a new thread that calls ``main(run)``. The caller starts the thread."""
        thread = threading.Thread(target=lambda: main(run), name="simulation", daemon=True)
        run = cls(thread, is_own=True)
        return run

    def is_mine(self) -> bool:
        """Return whether the calling thread is the run's thread. If so, the caller is one of the run's controllers."""
        return self.thread is threading.current_thread() and not self.finished.is_set()

    def wait_for_lap(self, seconds: float) -> bool:
        """Wait for the run's next lap or its end. Return False on timeout."""
        before, deadline = self.laps, time.monotonic() + seconds
        while self.laps == before and not self.finished.wait(POLL_EVERY):
            if time.monotonic() > deadline:
                return False
        return True

    def abandon(self) -> None:
        """Mark the run as abandoned and finished, and ask it to end."""
        self.abandoned = True
        self.stopping.set()
        self.finished.set()

    def at_work(self) -> tuple[str, str]:
        """Return the class name of the controller that was called last, and the file that defines the class."""
        kind = type(self.controller)
        return ("MuJoCo", "") if self.controller is None else (kind.__name__, file_of(kind))


class SteppedWorld:
    """Bodies in one MuJoCo world, and the controllers that move them.

    Only one thread at a time may initialize or step the world. Methods that call controllers expect the caller's `Run`,
    record in it which controller they call, and return early once the run is abandoned.

    Args:
        placements: the bodies.
        controllers: pairs of a body's name ("" for the world) and a controller, in the order they are called.
        time_step: the time step [s].
        find_camera: finds a camera of a simulated body (see `Body`); None for a world without camera images.

    Attributes:
        model: the composed MuJoCo model.
        data: the model's state; only the thread that steps the world may use it.
        time_step: the given time step.
        bodies: the simulated bodies by name.
        requests: requests from other threads, which are carried out between two steps.
        step: the number of steps that have been simulated.
        initialized: whether the controllers have been initialized and have not been dismissed since.

    Raises:
        TutorialError: the bodies cannot form a world.
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
        self.requests = RequestQueue()
        self.initialized = False
        self.step = 0

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.step * self.time_step

    def snapshot(self) -> Snapshot:
        """Return a copy of the state. Call it only on the thread that steps the world."""
        return Snapshot(self.time, self.data.qpos.copy())

    def initialize(self, run: Run) -> None:
        """Initialize all controllers, unless they are already initialized.

        If a controller fails, stop the controllers that were initialized before it.

        Raises:
            ControllerError: a controller raised an exception.
        """
        if self.initialized:
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
            failed = self.controller_error(run, error)
            self.stop_controllers(run, ready)
            raise failed from error
        run.controller = None
        self.initialized = True

    def run_steps(self, run: Run, count: int) -> bool:
        """Take ``count`` steps: in each, carry out the waiting requests, call every controller, and let MuJoCo step.

        Returns:
            True if all steps were taken; False if the run had to end early.

        Raises:
            ControllerError: a controller raised an exception.
        """
        model, data, mj_step = self.model, self.data, mujoco.mj_step
        run.laps += 1
        try:
            for _ in range(count):
                self.requests.run_waiting()
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
                raise  # the user pressed Ctrl-C between two controllers
            raise self.controller_error(run, error) from error
        return True

    def dismiss(self) -> list[SimpleController]:
        """Return the controllers, which the caller must stop. The next run initializes them again."""
        self.initialized = False
        return [controller for controller, _ in self._controllers]

    def release(self, body: str) -> list[SimpleController]:
        """Remove a body's controllers and return them. The caller must stop them."""
        leaving = [controller for controller, io in self._controllers if io.body.name == body]
        self._controllers = [(c, io) for c, io in self._controllers if io.body.name != body]
        return leaving

    def stop_controllers(self, run: Run, controllers: Iterable[SimpleController]) -> ControllerError | None:
        """Stop the controllers one by one. Log each failure, and continue with the next controller.

        Returns:
            The last error; None if no controller failed.
        """
        failed = None
        for controller in controllers:
            run.controller = controller
            try:
                controller.stop()
            except BaseException as error:  # noqa: BLE001 - the other controllers still have to stop
                failed = self.controller_error(run, error)
                _log.error("%s", failed, exc_info=error)
            if run.abandoned:
                break
        return failed

    def controller_error(self, run: Run, error: BaseException) -> ControllerError:
        """Return an error that names the failed controller, the simulated time and the line."""
        name, file = run.at_work()
        return ControllerError(f"{name} failed at {self.time:.3f} s of simulated time: {describe_error(error, file)}")
