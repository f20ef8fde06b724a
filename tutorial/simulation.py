"""A simulation that can be started and stopped: a stepped world, and the thread that steps it in real time."""

import logging
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from enum import Enum

from tutorial.body import FindCamera
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, where
from tutorial.stepped_world import ControllerError, Run, SteppedWorld
from tutorial.world import Placement

SWITCH_INTERVAL = 0.0002  # [s]; with Python's 0.005 a busy cell starves a thread that wakes a thousand times a second
USUAL_INTERVAL = sys.getswitchinterval()
REST = 0.002  # [s] between two batches of steps
LONGEST_DEBT = 0.25  # [s] of real time that the simulation tries to catch up; what is beyond is given up
REPORT_EVERY = 5.0  # [s] between two complaints that the machine can't keep up
STUCK = 3.0  # [s] that the controllers may take to return when somebody waits for them
SLOW = 0.95  # of real time, below which the machine is said not to keep up

_log = logging.getLogger(__name__)


class State(Enum):
    """What a simulation does.

    ``start`` and ``advance`` lead from IDLE or FAILED to RUNNING. From there it comes to IDLE when the duration is over
    or at ``stop``. If a controller raises, also when it is stopped, the simulation is FAILED in the end. If one does
    not return, it is ABANDONED for ever.
    """

    IDLE = "idle"  #: nothing; it can be stepped
    RUNNING = "running"  #: it is being stepped, on its own thread or by `Simulation.advance`
    FAILED = "failed"  #: nothing, because a controller raised: `Simulation.error`. It can be stepped again
    ABANDONED = "abandoned"  #: nothing ever again: a controller does not return, and may still touch what it was given


class Simulation(SteppedWorld):
    """A copy of some bodies in one MuJoCo world, and the controllers that move them.

    It can be stepped at once, with `advance`, or in real time on a thread of its own, with `start` and `stop`; in both
    cases controllers see only the copy, through the `ControllerIO` that they are initialized with. Whatever a
    controller raises becomes a `ControllerError`, also where it wants to end the program. If one does not return, the
    simulation waits a few seconds for it; then it is abandoned, and nobody touches it any more.

    The methods may be called on any thread, except by a controller. The arguments are those of `SteppedWorld`.

    Attributes:
        state: what it does now.
        error: what a controller raised last, since the last start; None when none did.
        rest: between two batches of steps in real time [s]. Longer batches take less of the processor.
    """

    rest = REST

    def __init__(
        self,
        placements: Sequence[Placement],
        controllers: Iterable[tuple[str, SimpleController]] = (),
        time_step: float = 0.001,
        find_camera: FindCamera | None = None,
    ) -> None:
        super().__init__(placements, controllers, time_step, find_camera)
        self.state = State.IDLE
        self.error: ControllerError | None = None
        self._turns = threading.Lock()  # held by the method that starts, stops or changes something
        self._lock = threading.Lock()  # held for a change of the state, and never while a controller is at work
        self._run = Run(threading.current_thread())  # the last one that stepped; before the first, one that is over
        self._run.finished.set()
        self._leaving = self._run  # the last one that stopped controllers, on a thread of its own

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
            raise TutorialError(f"advance({seconds}): time does not go back. Give seconds >= 0.")
        run, error = Run(threading.current_thread()), None
        try:
            with self._turn("advance()"):
                self._check_idle("the simulation is running on its own thread. Call stop() before advance().")
                self._begin(run)
            self._initialize(run)
            done = self._run_steps(run, round(seconds / self.time_step))
        except ControllerError as raised:
            error = raised
            raise
        finally:
            self._end(run, error)
        if run.abandoned:
            self._check_abandoned()
        if not done:
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
            self._check_idle("the simulation is running already. Call stop() first.")
            last_step = None if duration is None else self.step + round(duration / self.time_step)
            thread = threading.Thread(target=lambda: self._main(run, last_step), name="simulation", daemon=True)
            run = Run(thread, is_own=True)
            self._begin(run)
            thread.start()

    def stop(self) -> None:
        """End the run and stop the controllers. Idempotent. What was simulated stays.

        A controller that does not return keeps its thread, which then ends with the process: `error` says where it is.
        """
        with self._turn("stop()"):
            self._run.stopping.set()
            self._wait_for(self._run)
            if self._initialized and self.state is not State.ABANDONED:
                self._initialized = False
                self._stop_controllers([controller for controller, _ in self._controllers])

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
            if not self._run.wait_for_lap(STUCK):  # until then a step may still ask those that leave
                self._abandon(self._run)
            if self._initialized and self.state is not State.ABANDONED:
                self._stop_controllers(leaving)
            self._check_abandoned()

    @contextmanager
    def _turn(self, caller: str) -> Iterator[None]:
        """Have one caller after the other start, stop or change something; a controller would wait for itself."""
        if self._run.is_mine() or self._leaving.is_mine():
            raise TutorialError(f"{caller} was called by a controller, and would wait for it. Call it elsewhere.")
        if not self._turns.acquire(timeout=2.5 * STUCK):  # a turn waits for controllers, at most twice
            raise TutorialError(f"{caller}: another thread is still stopping this simulation. Call it again later.")
        try:
            yield
        finally:
            self._turns.release()

    def _check_abandoned(self) -> None:
        if self.state is State.ABANDONED:
            raise ControllerError(str(self.error))

    def _check_idle(self, otherwise: str) -> None:
        self._check_abandoned()
        if self.running:
            raise TutorialError(otherwise)

    def _begin(self, run: Run) -> None:
        with self._lock:
            self.state, self.error, self._run = State.RUNNING, None, run

    def _end(self, run: Run, error: ControllerError | None) -> None:
        """Note how a run has come to its end; one that was abandoned, or never began, leaves everything alone."""
        with self._lock:
            if self._run is not run or run.finished.is_set():
                return
            self.snapshot.put(self._snap())
            self.error = error or self.error
            self.state = State.FAILED if self.error else State.IDLE
            run.finished.set()

    def _abandon(self, stuck: Run) -> None:
        """Give up a controller that does not return, and with it the simulation: nobody may touch either any more."""
        with self._lock:
            if stuck.finished.is_set():
                return
            name, file = stuck.at_work()
            stands = f"{name} does not return{where(stuck.thread, file)}"
            text = f"{stands}. Mend it, and make the simulation anew: open its program again."
            self.state, self.error = State.ABANDONED, ControllerError(text)
            stuck.abandon()
            if not self._run.finished.is_set():
                self._run.abandon()
        _log.error("%s", text)

    def _wait_for(self, run: Run) -> None:
        """Wait for the end of a run, or give it up."""
        if not run.finished.wait(STUCK):
            self._abandon(run)
        if run.is_own and not run.abandoned:
            run.thread.join(STUCK)  # it has nothing more to do

    def _stop_controllers(self, controllers: list[SimpleController]) -> None:
        """Stop controllers on a thread that can be given up, as any of them may keep it."""
        thread = threading.Thread(target=lambda: self._stop_main(run, controllers), name="simulation", daemon=True)
        self._leaving = run = Run(thread, is_own=True)
        thread.start()
        self._wait_for(run)

    def _stop_main(self, run: Run, controllers: list[SimpleController]) -> None:
        """The thread on which controllers are stopped."""
        failed = self._stop_each(run, controllers)
        with self._lock:
            if failed is not None and not run.abandoned:
                self.error = failed
                self.state = State.FAILED if self.state is State.IDLE else self.state
            run.finished.set()

    def _main(self, run: Run, last_step: int | None) -> None:
        """The simulation's thread."""
        failed: ControllerError | None = None
        try:
            self._initialize(run)
            self._keep_pace(run, last_step)
        except BaseException as error:  # noqa: BLE001 - whatever it is, the thread must not end without a word
            failed = error if isinstance(error, ControllerError) else self._controller_error(run, error)
            _log.error("%s", failed)
        sys.setswitchinterval(USUAL_INTERVAL)
        self._end(run, failed)

    def _keep_pace(self, run: Run, last_step: int | None) -> None:
        """Step so that simulated time follows real time.

        The pace is reckoned from one origin, so that rounding and sleeping too long don't add up.
        """
        pace = _Pace(self.step, self.time_step)
        while not run.stopping.is_set() and (last_step is None or self.step < last_step):
            sys.setswitchinterval(SWITCH_INTERVAL)  # each time: another simulation that ends puts it back
            due = pace.steps_due(self.step)
            if last_step is not None:
                due = min(due, last_step - self.step)
            self._run_steps(run, due)
            if not run.abandoned:
                self.snapshot.put(self._snap())
            time.sleep(self.rest)


class _Pace:
    """Reckons how many steps are due, and says when the machine can't keep up."""

    def __init__(self, step: int, time_step: float) -> None:
        self._time_step = time_step
        self._origin = time.perf_counter() - step * time_step  # when step 0 would have been
        self._lost, self._since = 0.0, time.perf_counter()

    def steps_due(self, step: int) -> int:
        """How many steps to take now, after so many."""
        now = time.perf_counter()
        debt = now - self._origin - step * self._time_step
        if debt > LONGEST_DEBT:
            self._origin += debt - LONGEST_DEBT
            self._lost += debt - LONGEST_DEBT
            debt = LONGEST_DEBT
        if now - self._since > REPORT_EVERY:
            ratio = 1.0 - self._lost / (now - self._since)
            if ratio < SLOW:
                _log.warning("this machine can't keep up: the simulation runs at %.2f of real time", ratio)
            self._lost, self._since = 0.0, now
        return int(min(debt, 0.1) / self._time_step)  # few enough to notice a stop at once
