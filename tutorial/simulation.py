"""The simulated copy of the world, stepped together with its controllers."""

from __future__ import annotations

import logging
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import Enum
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

__all__ = ["ControllerError", "Simulation", "Snapshot", "State"]

SWITCH_INTERVAL = 0.0002  # [s]; with Python's 0.005 a busy cell starves a thread that wakes a thousand times a second
REST = 0.002  # [s] between two batches of steps
LONGEST_DEBT = 0.25  # [s] of real time that the simulation tries to catch up; what is beyond is given up
REPORT_EVERY = 5.0  # [s] between two complaints that the machine can't keep up
STUCK = 3.0  # [s] that a controller may take to return when somebody waits for it
SLOW = 0.95  # of real time, below which the machine is said not to keep up

_log = logging.getLogger(__name__)


class ControllerError(TutorialError):
    """A controller raised, or does not return; the simulation has stopped. What was raised is the cause of this one."""


class State(Enum):
    """What a simulation does; every method asks it first."""

    IDLE = "idle"  #: nothing; it can be stepped
    RUNNING = "running"  #: it is being stepped, on its own thread or by `Simulation.advance`
    FAILED = "failed"  #: nothing, because a controller raised: `Simulation.error`. It can be stepped again
    ABANDONED = "abandoned"  #: nothing ever again: a controller does not return, and may still touch what it was given


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
    cases controllers see only the copy, through the `ControllerIO` that they are initialized with. Whatever a
    controller raises becomes a `ControllerError`, also where it wants to end the program. One that does not return is
    waited for only so long; then the simulation is abandoned, and nobody touches it any more.

    The methods may be called on any thread, except by a controller.

    Args:
        placements: the bodies.
        controllers: pairs of a body's name ("" for the world) and a controller, in the order in which they are asked.
        time_step: [s].

    Attributes:
        error: what a controller raised last, since the last start; None when none did.
        snapshot: the newest state to be shown.

    Raises:
        TutorialError: the bodies do not make a world.
    """

    def __init__(
        self,
        placements: Sequence[Placement],
        controllers: Iterable[tuple[str, SimpleController]] = (),
        time_step: float = 0.001,
    ) -> None:
        self.model = compose(placements, time_step)
        self.data = mujoco.MjData(self.model)
        self.time_step = time_step
        self.bodies = {p.name: Body(p.name, self.model, self.data) for p in placements}
        places = self.bodies | {"": Body("", self.model, self.data)}
        self._controllers = [(each, ControllerIO(places[name], time_step)) for name, each in controllers]
        self._step = 0
        self._initialized = False
        self._duration: float | None = None  # of the last start
        self._turns = threading.Lock()  # held by the method that starts, stops or changes something
        self._lock = threading.Lock()  # held for a change of the state, and never while a controller is at work
        self._run: _Run | None = None  # while it is stepped
        self._leaving: _Run | None = None  # while controllers are stopped
        self._thread: threading.Thread | None = None  # of the last start
        self._abandoned = ""  # why
        self.error: ControllerError | None = None
        self.snapshot = Latest(self._snap())

    @property
    def state(self) -> State:
        """What the simulation does now."""
        if self._abandoned:
            return State.ABANDONED
        if self._run is not None:
            return State.RUNNING
        return State.IDLE if self.error is None else State.FAILED

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
        """Whether it is being stepped."""
        return self.state is State.RUNNING

    def advance(self, seconds: float) -> None:
        """Step as fast as possible, on the calling thread.

        Args:
            seconds: simulated time to go on by [s]; rounded to whole steps.

        Raises:
            ControllerError: a controller raised, and the simulation stops there; or one has never returned.
            TutorialError: the simulation is running, or another thread has stopped it meanwhile.
        """
        if seconds < 0:
            raise TutorialError(f"advance({seconds}): time does not go back. Give seconds >= 0, or call restart().")
        run, error = _Run(threading.current_thread()), None
        try:
            with self._turn("advance()"):
                self._check_idle("the simulation is running on its own thread. Call stop() before advance().")
                self._begin(run)
            last_step = self._step + round(seconds / self.time_step)
            self._initialize(run)
            self._run_steps(run, last_step - self._step)
        except ControllerError as raised:
            error = raised
            raise
        finally:
            self._end(run, error)
        if run.abandoned:
            raise ControllerError(self._abandoned)
        if self._step < last_step and run.stopping.is_set():
            raise TutorialError(f"advance({seconds}) was stopped elsewhere, at {self.time:.3f} s. Call it again.")

    def start(self, duration: float | None = None) -> None:
        """Step in real time, on a thread of its own.

        Args:
            duration: stop after this much simulated time [s]; None to go on until `stop`.

        Raises:
            ControllerError: a controller of it has never returned.
            TutorialError: it is running already.
        """
        with self._turn("start()"):
            self._check_idle("the simulation is running already. Call stop() first, or restart().")
            self._start(duration)

    def stop(self) -> None:
        """End the run and stop the controllers. Idempotent. What was simulated stays.

        A controller that does not return keeps its thread, which then ends with the process: `error` says where it is.
        """
        with self._turn("stop()"):
            self._halt()
            self._stop_all()

    def restart(self) -> None:
        """Go back to time 0 and the initial pose, with controllers initialized anew.

        If it was running on its own thread, it starts again, for as long as it was started for.

        Raises:
            ControllerError: a controller does not return.
        """
        with self._turn("restart()"):
            run = self._run
            self._halt()
            if not self._abandoned:
                self.error = None
            self._stop_all()
            self._check_abandoned()
            mujoco.mj_resetData(self.model, self.data)
            self._step = 0
            self.snapshot.put(self._snap())
            if run is not None and run.thread is self._thread:
                self._start(self._duration)

    def wait(self, timeout: float | None = None) -> bool:
        """Block until nobody steps the simulation any more: it has come to its end, was stopped, or was abandoned.

        Args:
            timeout: how long to wait at most [s]; None for ever.

        Returns:
            Whether it is so.
        """
        self._check_caller("wait()")
        run = self._run
        return run is None or run.finished.wait(timeout)

    def release(self, body: str) -> None:
        """Stop the controllers of a body, for good; the body itself stays in the world, which may be running.

        Args:
            body: the body's name.

        Raises:
            ControllerError: a controller does not return.
        """
        with self._turn("release()"):
            self._check_abandoned()
            leaving = [controller for controller, io in self._controllers if io.body.name == body]
            self._controllers = [(c, io) for c, io in self._controllers if io.body.name != body]
            run = self._run
            if run is not None and not run.pass_on():
                self._abandon(run)
            if self._initialized and not self._abandoned:
                self._stop_controllers(leaving)
            self._check_abandoned()

    def copy_to(self, bodies: Iterable[Body]) -> float:
        """Move displayed bodies to where the newest snapshot has them. Main thread, in every state.

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

    @contextmanager
    def _turn(self, caller: str) -> Iterator[None]:
        """Have one caller after the other start, stop or change something."""
        self._check_caller(caller)
        if not self._turns.acquire(timeout=2.5 * STUCK):  # who has it waits for controllers, at most twice
            raise TutorialError(f"{caller}: another thread is still stopping this simulation. Call it again later.")
        try:
            yield
        finally:
            self._turns.release()

    def _check_caller(self, caller: str) -> None:
        """Refuse a controller, which would wait for itself."""
        if any(run is not None and run.thread is threading.current_thread() for run in (self._run, self._leaving)):
            raise TutorialError(f"{caller} was called by a controller, and would wait for it. Call it elsewhere.")

    def _check_abandoned(self) -> None:
        if self._abandoned:
            raise ControllerError(self._abandoned)

    def _check_idle(self, otherwise: str) -> None:
        self._check_abandoned()
        if self._run is not None:
            raise TutorialError(otherwise)

    def _begin(self, run: _Run) -> None:
        with self._lock:
            self.error, self._run = None, run

    def _end(self, run: _Run, error: ControllerError | None) -> None:
        """Note how a run has come to its end; one that was abandoned, or never began, leaves everything alone."""
        with self._lock:
            if self._run is not run:
                return
            self.snapshot.put(self._snap())
            self.error = error or self.error
            _switching.release(run)
            self._run = None
            run.finished.set()

    def _abandon(self, stuck: _Run) -> None:
        """Give up a controller that does not return, and with it the simulation: nobody may touch either any more."""
        with self._lock:
            if stuck.finished.is_set():
                return
            self._abandoned = f"{stuck.place()}. Mend it, and make the simulation anew: open its program again."
            self.error = ControllerError(self._abandoned)
            for run in filter(None, (stuck, self._run)):
                run.abandoned = True
                run.stopping.set()
                run.finished.set()
                _switching.release(run)
            self._run = None
        _log.error("%s", self._abandoned)

    def _start(self, duration: float | None) -> None:
        """Begin a thread of its own."""
        self._duration = duration
        last_step = None if duration is None else self._step + round(duration / self.time_step)
        run = _Run()
        run.thread = threading.Thread(target=self._main, args=(run, last_step), name="simulation", daemon=True)
        self._thread = run.thread
        try:
            self._begin(run)
            _switching.hold(run)
            run.thread.start()
        except BaseException:
            self._end(run, None)
            raise

    def _halt(self) -> None:
        """Have the run come to its end, or give it up."""
        run = self._run
        if run is not None:
            run.stopping.set()
            if not run.finished.wait(STUCK):
                self._abandon(run)
        if self._thread and not self._abandoned:
            self._thread.join(STUCK)  # it has nothing more to do

    def _stop_all(self) -> None:
        if self._initialized and not self._abandoned:
            self._initialized = False
            self._stop_controllers([controller for controller, _ in self._controllers])

    def _stop_controllers(self, controllers: list[SimpleController]) -> None:
        """Stop controllers on a thread that can be given up, as any of them may keep it."""
        if not controllers:
            return
        run = self._leaving = _Run()
        run.thread = threading.Thread(target=self._stop_each, args=(run, controllers), name="simulation", daemon=True)
        run.thread.start()
        run.thread.join(STUCK)
        if run.thread.is_alive():
            self._abandon(run)
        self._leaving = None

    def _stop_each(self, run: _Run, controllers: list[SimpleController]) -> None:
        """Stop one controller after the other. One that fails is logged and kept, and holds up none of the others."""
        for run.asked in controllers:
            try:
                run.asked.stop()
            except BaseException as error:  # noqa: BLE001 - whatever it is, the others still have to stop
                failed = self._controller_error(run, error)
                _log.error("%s", failed, exc_info=error)
                with self._lock:
                    self.error = self.error if run.abandoned else failed
            if run.abandoned:
                return

    def _main(self, run: _Run, last_step: int | None) -> None:
        """The simulation's thread."""
        failed: ControllerError | None = None
        try:
            self._initialize(run)
            self._keep_pace(run, last_step)
        except BaseException as error:  # noqa: BLE001 - whatever it is, the thread must not end without a word
            failed = error if isinstance(error, ControllerError) else self._controller_error(run, error)
            _log.error("%s", failed)
        self._end(run, failed)

    def _keep_pace(self, run: _Run, last_step: int | None) -> None:
        """Step so that simulated time follows real time.

        When to be where is reckoned from one origin, so that rounding and sleeping too long don't add up.
        """
        pace = _Pace(self._step, self.time_step)
        while not run.stopping.is_set() and (last_step is None or self._step < last_step):
            due = pace.steps_due(self._step)
            if last_step is not None:
                due = min(due, last_step - self._step)
            self._run_steps(run, due)
            if not run.abandoned:
                self.snapshot.put(self._snap())
            time.sleep(REST)

    def _run_steps(self, run: _Run, count: int) -> None:
        model, data, mj_step = self.model, self.data, mujoco.mj_step
        run.laps += 1
        try:
            for _ in range(count):
                if run.stopping.is_set():
                    return
                for run.asked, io in self._controllers:
                    io.step = self._step
                    run.asked.control()
                    if run.abandoned:
                        return
                run.asked = None
                mj_step(model, data)
                self._step += 1
                run.laps += 1
        except BaseException as error:
            if run.asked is None and not isinstance(error, Exception):
                raise  # the reader's Ctrl-C, between two controllers
            raise self._controller_error(run, error) from error

    def _initialize(self, run: _Run) -> None:
        """Let every controller look at the state it starts from, once a start: all of them, or none."""
        if self._initialized:
            return
        mujoco.mj_forward(self.model, self.data)
        ready: list[SimpleController] = []
        try:
            for run.asked, io in self._controllers:
                io.step = self._step
                run.asked.initialize(io)
                if run.abandoned:
                    return
                ready.append(run.asked)
        except BaseException as error:
            failed = self._controller_error(run, error)
            self._stop_each(run, ready)
            raise failed from error
        run.asked = None
        self._initialized = True

    def _controller_error(self, run: _Run, error: BaseException) -> ControllerError:
        when = f"failed at {self.time:.3f} s of simulated time"
        if run.asked is None:
            return ControllerError(f"MuJoCo {when}: {tell(error, '')}")
        kind = type(run.asked)
        return ControllerError(f"{kind.__name__} {when}: {tell(error, file_of(kind))}")

    def _snap(self) -> Snapshot:
        return Snapshot(self.time, self.data.qpos.copy())


@dataclass(eq=False)
class _Run:
    """What goes on on a thread that asks controllers."""

    thread: threading.Thread | None = None
    asked: SimpleController | None = None  # the controller that is at work, or was last
    laps: int = 0  # grows whenever no controller is at work
    stopping: threading.Event = field(default_factory=threading.Event)  # asks it to come to its end
    finished: threading.Event = field(default_factory=threading.Event)  # it has, or it was abandoned
    abandoned: bool = False  # it may not touch the simulation any more

    def pass_on(self) -> bool:
        """Wait until the run has come to its next lap, or to its end; False when it does neither."""
        before, deadline = self.laps, time.monotonic() + STUCK
        while self.laps == before and not self.finished.wait(REST / 2):
            if time.monotonic() > deadline:
                return False
        return True

    def place(self) -> str:
        """Say which controller does not return, and where it is."""
        asked, thread = self.asked, self.thread
        name, file = ("MuJoCo", "") if asked is None else (type(asked).__name__, file_of(type(asked)))
        return f"{name} does not return{where(thread, file) if thread is not None else ''}"


class _Switching:
    """Python's switch interval, short as long as anybody holds it; the last to release it puts it back."""

    def __init__(self) -> None:
        self._lock, self._before = threading.Lock(), 0.0
        self._holders: set[object] = set()

    def hold(self, holder: object) -> None:
        with self._lock:
            if not self._holders:
                self._before = sys.getswitchinterval()
                sys.setswitchinterval(SWITCH_INTERVAL)
            self._holders.add(holder)

    def release(self, holder: object) -> None:
        """Do without it from now on. Idempotent."""
        with self._lock:
            held = bool(self._holders)
            self._holders.discard(holder)
            if held and not self._holders:
                sys.setswitchinterval(self._before)


_switching = _Switching()


class _Pace:
    """Reckons how many steps are due, and says when the machine can't keep up."""

    def __init__(self, step: int, time_step: float) -> None:
        self._time_step = time_step
        self._origin = time.perf_counter() - step * time_step  # when step 0 would have been
        self._lost, self._since = 0.0, time.perf_counter()

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
