"""The simulated copy of the world, stepped together with its controllers."""

from __future__ import annotations

import logging
import sys
import threading
import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import mujoco

from tutorial.body import Body
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError, file_of, tell, where
from tutorial.handoff import Latest
from tutorial.world import Placement, compose

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["ControllerError", "Simulation", "Snapshot"]

SWITCH_INTERVAL = 0.0002  # [s]; with Python's 0.005 a busy cell starves a thread that wakes a thousand times a second
REST = 0.002  # [s] between two batches of steps
LONGEST_DEBT = 0.25  # [s] of real time that the simulation tries to catch up; what is beyond is given up
REPORT_EVERY = 5.0  # [s] between two complaints that the machine can't keep up
STUCK = 3.0  # [s] that a controller may take to return when the simulation is stopped
SLOW = 0.95  # of real time, below which the machine is said not to keep up

_log = logging.getLogger(__name__)


class ControllerError(TutorialError):
    """A controller raised an exception; the simulation has stopped, and the exception is the cause of this one."""


@dataclass(frozen=True)
class Snapshot:
    """The state of the whole simulated world at one moment, as a copy.

    Attributes:
        time: simulated time [s].
        qpos: MuJoCo's generalised positions, shape (nq,).
    """

    time: float
    qpos: NDArray[np.float64]


class Simulation:
    """A copy of some bodies in one MuJoCo world, and the controllers that move them.

    It can be stepped at once, with `advance`, or in real time on a thread of its own, with `start` and `stop`; in both
    cases controllers see only the copy, through the `ControllerIO` that they are initialized with.

    Args:
        placements: the bodies.
        controllers: pairs of a body's name and a controller of it, in the order in which they are asked for control.
        time_step: [s].

    Raises:
        TutorialError: the bodies do not make a world.
    """

    def __init__(
        self,
        placements: Iterable[Placement],
        controllers: Iterable[tuple[str, SimpleController]] = (),
        time_step: float = 0.001,
    ) -> None:
        self._placements = tuple(placements)
        self.model = compose(self._placements, time_step)
        self.data = mujoco.MjData(self.model)
        self.time_step = time_step
        self.bodies = {p.name: Body(p.name, self.model, self.data) for p in self._placements}
        self._controllers = [
            (controller, ControllerIO(self.bodies[name], time_step)) for name, controller in controllers
        ]
        self._step = 0
        self._initialized = False
        self._thread: threading.Thread | None = None
        self._duration: float | None = None  # of the last start
        self._given_up = False  # a controller keeps the thread
        self._stepping = threading.Lock()  # held for a batch of steps
        self._stopping = threading.Event()
        self._finished = threading.Event()
        self.error: ControllerError | None = None
        self.snapshot = Latest(self._snap())

    @property
    def step(self) -> int:
        """How many steps have been simulated since the start."""
        return self._step

    @property
    def time(self) -> float:
        """Simulated time since the start [s]."""
        return self._step * self.time_step

    @property
    def running(self) -> bool:
        """Whether the simulation's own thread is stepping."""
        return self._thread is not None and not self._finished.is_set()

    def advance(self, seconds: float) -> None:
        """Step as fast as possible, on the calling thread.

        Args:
            seconds: simulated time to go on by [s]; rounded to whole steps.

        Raises:
            ControllerError: a controller raised; the simulation stops there.
            TutorialError: the simulation is running on its own thread.
        """
        if self.running:
            raise TutorialError("the simulation is running on its own thread. Call stop() before advance().")
        if seconds < 0:
            raise TutorialError(f"advance({seconds}): time does not go back. Give seconds >= 0, or call restart().")
        self._initialize()
        try:
            self._run_steps(round(seconds / self.time_step))
        finally:
            self.snapshot.put(self._snap())

    def start(self, duration: float | None = None) -> None:
        """Step in real time, on a thread of its own.

        Args:
            duration: stop after this much simulated time [s]; None to go on until `stop`.

        Raises:
            TutorialError: it is running already, or a controller of it has never returned.
        """
        if self.running:
            raise TutorialError("the simulation is running already. Call stop() first, or restart().")
        self._join()
        if self._given_up:
            raise TutorialError("a controller of this simulation has not returned. Mend it, and make a new simulation.")
        self._stopping.clear()
        self._finished.clear()
        self._duration = duration
        self.error = None
        last_step = None if duration is None else self._step + round(duration / self.time_step)
        self._thread = threading.Thread(target=self._main, args=(last_step,), name="simulation", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End the thread and let the controllers go. Idempotent. What was simulated stays."""
        self._stopping.set()
        self._join()
        self._let_go()

    def restart(self) -> None:
        """Go back to time 0 and the initial pose, with controllers initialized anew.

        If it was running, it starts again, for as long as it was started for.
        """
        running = self.running
        self.stop()
        mujoco.mj_resetData(self.model, self.data)
        self._step = 0
        self.snapshot.put(self._snap())
        if running:
            self.start(self._duration)

    def wait(self, timeout: float | None = None) -> bool:
        """Block until the thread has come to its end by itself.

        Args:
            timeout: how long to wait at most [s]; None for ever.

        Returns:
            Whether it has.
        """
        return self._finished.wait(timeout)

    def release(self, body: str) -> None:
        """Let the controllers of a body go; the body itself stays in the world. Any thread, also while it is running.

        Args:
            body: the body's name.
        """
        with self._stepping:
            leaving = [controller for controller, io in self._controllers if io.body.name == body]
            self._controllers = [(c, io) for c, io in self._controllers if io.body.name != body]
            initialized = self._initialized
        if initialized:
            _stop_all(leaving)

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

    def _main(self, last_step: int | None) -> None:
        """The simulation's thread."""
        interval = sys.getswitchinterval()
        sys.setswitchinterval(SWITCH_INTERVAL)
        try:
            self._initialize()
            self._keep_pace(last_step)
        except ControllerError as error:
            self.error = error
        finally:
            self.snapshot.put(self._snap())
            sys.setswitchinterval(interval)
            self._finished.set()

    def _keep_pace(self, last_step: int | None) -> None:
        """Step so that simulated time follows real time.

        When to be where is reckoned from one origin, so that rounding and sleeping too long don't add up.
        """
        pace = _Pace(self._step, self.time_step)
        while not self._stopping.is_set() and (last_step is None or self._step < last_step):
            due = pace.steps_due(self._step)
            if last_step is not None:
                due = min(due, last_step - self._step)
            self._run_steps(due)
            self.snapshot.put(self._snap())
            time.sleep(REST)

    def _run_steps(self, count: int) -> None:
        model, data, mj_step = self.model, self.data, mujoco.mj_step
        controller: SimpleController | None = None
        try:
            with self._stepping:
                for _ in range(count):
                    for controller, io in self._controllers:
                        io.step = self._step
                        controller.control()
                    controller = None
                    mj_step(model, data)
                    self._step += 1
        except Exception as error:
            raise self._controller_error(controller, error) from error

    def _initialize(self) -> None:
        """Let every controller look at the state it starts from, once a start: all of them, or none."""
        if self._initialized:
            return
        mujoco.mj_forward(self.model, self.data)
        ready: list[SimpleController] = []
        with self._stepping:
            for controller, io in self._controllers:
                io.step = self._step
                try:
                    controller.initialize(io)
                except Exception as error:
                    _stop_all(ready)
                    raise self._controller_error(controller, error) from error
                ready.append(controller)
            self._initialized = True

    def _let_go(self) -> None:
        if not self._initialized:
            return
        self._initialized = False
        _stop_all(controller for controller, _ in self._controllers)

    def _controller_error(self, controller: SimpleController | None, error: Exception) -> ControllerError:
        when = f"failed at {self.time:.3f} s of simulated time"
        if controller is None:
            return ControllerError(f"MuJoCo {when}: {type(error).__name__}: {error}")
        kind = type(controller)
        return ControllerError(f"{kind.__name__} {when}: {tell(error, file_of(kind))}")

    def _join(self) -> None:
        """Wait for the end of the thread; one that a controller keeps is given up, and ends with the process."""
        if self._thread is not None:
            self._thread.join(STUCK)
            if self._thread.is_alive():
                _log.error("the simulation does not stop, because a controller does not return%s", where(self._thread))
                self._finished.set()
                self._initialized = False
                self._given_up = True
            self._thread = None

    def _snap(self) -> Snapshot:
        return Snapshot(self.time, self.data.qpos.copy())


def _stop_all(controllers: Iterable[SimpleController]) -> None:
    for controller in controllers:
        try:
            controller.stop()
        except Exception:  # noqa: BLE001 - whatever it is, the others still have to stop
            _log.exception("%s failed in stop()", type(controller).__name__)


class _Pace:
    """Reckons how many steps are due, and says when the machine can't keep up."""

    def __init__(self, step: int, time_step: float) -> None:
        self._time_step = time_step
        self._origin = time.perf_counter() - step * time_step  # when step 0 would have been
        self._lost = 0.0
        self._since = time.perf_counter()

    def steps_due(self, step: int) -> int:
        now = time.perf_counter()
        debt = now - self._origin - step * self._time_step
        if debt > LONGEST_DEBT:
            self._origin += debt - LONGEST_DEBT
            self._lost += debt - LONGEST_DEBT
            debt = LONGEST_DEBT
        if now - self._since > REPORT_EVERY:
            self._report(now)
        return int(min(debt, 10 * REST) / self._time_step)  # few enough to notice a stop at once

    def _report(self, now: float) -> None:
        ratio = 1.0 - self._lost / (now - self._since)
        if ratio < SLOW:
            _log.warning("this machine can't keep up: the simulation runs at %.2f of real time", ratio)
        self._lost, self._since = 0.0, now
