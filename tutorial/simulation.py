"""A simulation that can be started and stopped: a world, and the thread that steps it in real time."""

import logging
import sys
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from enum import Enum

from tutorial.body import Body, FindCamera
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, where
from tutorial.handoff import NOT_RUNNING, Latest
from tutorial.stepped_world import ControllerError, Run, SteppedWorld
from tutorial.world import Placement

SWITCH_INTERVAL = 0.0002  # [s]; with the default, 0.005, a busy cell starves a thread that wakes every millisecond
USUAL_INTERVAL = sys.getswitchinterval()
REST = 0.002  # [s] between batches of steps
LONGEST_DEBT = 0.25  # [s] the longest delay that the simulation makes up for; it skips the rest
REPORT_EVERY = 5.0  # [s] between warnings that the machine can't keep up
STUCK = 3.0  # [s] how long a caller waits for controllers to return
SLOW = 0.95  # times real time; if the simulation runs more slowly, the machine can't keep up
LONGEST_BATCH = 0.1  # [s] of simulated time per batch of steps, so that a stop takes effect soon

_log = logging.getLogger(__name__)


class State(Enum):
    """The state of a `Simulation`, whose docstring contains the table of transitions."""

    IDLE = "idle"  #: not being stepped; ready to step
    RUNNING = "running"  #: stepped by its own thread, or by the thread that called `Simulation.advance`
    FAILED = "failed"  #: stopped by a controller's exception, `Simulation.error`; can be stepped again
    ABANDONED = "abandoned"  #: stopped permanently: a controller does not return, and may still change its body


class Simulation:
    """A world of simulated bodies and their controllers, and the thread that steps it.

    `advance` steps as fast as possible on the calling thread; `start` steps in real time on a separate thread, until
    `stop` is called. A controller can access only the simulated copy of its body, through the `ControllerIO` that
    its `initialize` receives. Any thread may call any method except `copy_to`; a controller must not call any of them.

    Every exception that a controller raises, even SystemExit, becomes a `ControllerError`. If a controller does not
    return within a few seconds of `stop` or `release`, the simulation is abandoned and never touched again:

    =========  ==============  ===========  ===================  ============================
    state      start, advance  run is over  a controller raises  a controller does not return
    =========  ==============  ===========  ===================  ============================
    IDLE       RUNNING         never        FAILED               ABANDONED
    RUNNING    refused         IDLE         FAILED               ABANDONED
    FAILED     RUNNING         never        FAILED               ABANDONED
    ABANDONED  refused         never        never                never
    =========  ==============  ===========  ===================  ============================

    A run is over when its duration has passed, or after `stop` or Ctrl-C. When no run is active, `stop` is the only
    controller method that is called. If a controller's `stop` raises an exception when `release` calls it during a run,
    the run continues, but ends in FAILED.

    Args:
        placements, controllers, time_step, find_camera: as for `SteppedWorld`.

    Attributes:
        world: the world; while the simulation runs, only the thread that steps the world may touch it.
        bodies, model, time_step: the world's bodies, model and time step.
        snapshot: the world's newest state, for other threads.
        state: the current state.
        error: the last controller error since the last start; None if there was no error.
        rest: the pause [s] after each batch of steps in a run that `start` began. A longer pause saves CPU time.

    Raises:
        TutorialError: the bodies cannot form a world.
    """

    rest = REST

    def __init__(
        self,
        placements: Sequence[Placement],
        controllers: Iterable[tuple[str, SimpleController]] = (),
        time_step: float = 0.001,
        find_camera: FindCamera | None = None,
    ) -> None:
        self.world = SteppedWorld(placements, controllers, time_step, find_camera)
        self.bodies = self.world.bodies
        self.model = self.world.model
        self.time_step = time_step
        self.snapshot = Latest(self.world.snapshot())
        self.state = State.IDLE
        self.error: ControllerError | None = None
        # Two locks, always acquired in this order. Methods that start, stop or change something run one after another,
        # and hold the first lock even while they wait for controllers. A change of state needs only the second lock,
        # which no thread holds while a controller runs. So a run can record its end while stop() holds the first lock
        # and waits for that end.
        self._turn_lock = threading.Lock()
        self._state_lock = threading.Lock()
        # The last run that stepped, and the last one that stopped controllers. They can overlap: release() stops some
        # controllers while a different thread steps the rest. Before the first run, both refer to a finished run.
        self._step_run = self._stop_run = Run(threading.current_thread())
        self._step_run.finished.set()

    @property
    def running(self) -> bool:
        """Whether a thread is stepping the simulation."""
        return self.state is State.RUNNING

    @property
    def step(self) -> int:
        """The number of steps that have been simulated."""
        return self.world.step

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.world.time

    def copy_to(self, bodies: Iterable[Body]) -> float:
        """Move displayed bodies to their positions in the newest snapshot. Main thread only.

        Args:
            bodies: displayed bodies; bodies that are not simulated do not move.

        Returns:
            The simulated time of the snapshot [s].
        """
        snapshot = self.snapshot.get()
        for body in bodies:
            simulated = self.bodies.get(body.name)
            if simulated is not None and len(body.qpos):
                body.qpos[:] = snapshot.qpos[simulated.qpos_slice]
                body.calc_forward_kinematics()
                body.notify_change()
        return snapshot.time

    def advance(self, seconds: float) -> None:
        """Step as fast as possible, on the calling thread.

        Args:
            seconds: how much time to simulate [s], rounded to whole steps.

        Raises:
            ControllerError: a controller raised an exception, and the simulation has stopped; or a controller from an
                earlier run never returned.
            TutorialError: the simulation is already running, or a different thread stopped it early.
        """
        if seconds < 0:
            raise TutorialError(f"advance({seconds}): time cannot run backwards. Pass seconds >= 0.")
        run = Run(threading.current_thread())
        error = None
        try:  # before the run begins, so that a Ctrl-C at any moment ends the run
            with self._turn("advance()"):
                self._check_idle("the simulation is running on its own thread. Call stop() before advance().")
                self._begin(run)
            self.world.initialize(run)
            is_complete = self.world.run_steps(run, round(seconds / self.time_step))
        except ControllerError as raised:
            error = raised
            raise
        finally:
            self._end(run, error)
        if run.abandoned:  # by a thread that waited for the run in stop() or release()
            self._check_abandoned()
        if not is_complete:
            raise TutorialError(f"another thread stopped advance({seconds}) at {self.time:.3f} s. Call it again.")

    def start(self, duration: float | None = None) -> None:
        """Step in real time, on a separate thread.

        Args:
            duration: stop after this much simulated time [s]; None to run until `stop` is called.

        Raises:
            ControllerError: a controller from an earlier run never returned.
            TutorialError: the simulation is already running.
        """
        with self._turn("start()"):
            self._check_idle("the simulation is already running. Call stop() first.")
            last_step = None if duration is None else self.step + round(duration / self.time_step)
            run = Run.on_own_thread(lambda run: self._main(run, last_step))
            self._begin(run)
            run.thread.start()

    def stop(self) -> None:
        """End the run and stop the controllers. The world keeps its state. Idempotent.

        If a controller does not return, its thread runs until the process ends, and `error` names its current line.
        """
        with self._turn("stop()"):
            self._step_run.stopping.set()
            self._wait_for(self._step_run)
            if self.world.initialized and self.state is not State.ABANDONED:
                self._stop_controllers(self.world.dismiss())

    def release(self, body: str) -> None:
        """Stop the controllers of a body permanently. The body stays in the world. The simulation may be running.

        Args:
            body: the body's name.

        Raises:
            ControllerError: a controller does not return.
        """
        with self._turn("release()"):
            self._check_abandoned()
            leaving = self.world.release(body)
            if not self._step_run.wait_for_lap(STUCK):  # before the next lap, a step may still call these controllers
                self._abandon(self._step_run)
            if self.world.initialized and self.state is not State.ABANDONED:
                self._stop_controllers(leaving)
            self._check_abandoned()

    @contextmanager
    def _turn(self, caller: str) -> Iterator[None]:
        """Let only one caller at a time start, stop or change the simulation.

        A call from a controller is rejected, because the controller would wait for itself.
        """
        if self._step_run.is_mine() or self._stop_run.is_mine():
            raise TutorialError(
                f"{caller} was called by a controller, and would wait forever for that controller. Call it elsewhere."
            )
        if not self._turn_lock.acquire(timeout=2.5 * STUCK):  # a turn waits for controllers at most twice
            raise TutorialError(f"{caller}: another thread is still stopping this simulation. Try again later.")
        try:
            yield
        finally:
            self._turn_lock.release()

    def _check_abandoned(self) -> None:
        if self.state is State.ABANDONED:
            raise ControllerError(str(self.error))

    def _check_idle(self, otherwise: str) -> None:
        self._check_abandoned()
        if self.running:
            raise TutorialError(otherwise)

    # The events, in the order of the table's columns. Only these methods change the state.

    def _begin(self, run: Run) -> None:
        """Go to RUNNING: a run begins."""
        with self._state_lock:
            self.state, self.error, self._step_run = State.RUNNING, None, run
            self.world.requests.open(run.thread)

    def _end(self, run: Run, error: ControllerError | None) -> None:
        """Go to IDLE, or to FAILED after an error. Do nothing if the run was abandoned or never began."""
        with self._state_lock:
            if self._step_run is not run or run.finished.is_set():
                return
            self.snapshot.put(self.world.snapshot())
            self.error = error or self.error
            self.state = State.FAILED if self.error else State.IDLE
            self.world.requests.close(f"the simulation has stopped: {self.error}" if self.error else NOT_RUNNING)
            run.finished.set()

    def _end_stopping(self, run: Run, error: ControllerError | None) -> None:
        """Go from IDLE to FAILED if stopping a controller failed. During a run, leave that change to `_end`."""
        with self._state_lock:
            if error is not None and not run.abandoned:
                self.error = error
                self.state = State.FAILED if self.state is State.IDLE else self.state
            run.finished.set()

    def _abandon(self, stuck: Run) -> None:
        """Go to ABANDONED: give up on a controller that does not return, and on everything that it may still touch."""
        with self._state_lock:
            if stuck.finished.is_set():
                return
            name, file = stuck.at_work()
            problem = f"{name}{' or a request' * (stuck.controller is None)} does not return{where(stuck.thread, file)}"
            text = f"{problem}. Fix the code, then open the program again: this simulation cannot continue."
            self.state, self.error = State.ABANDONED, ControllerError(text)
            self.world.requests.close(text)
            stuck.abandon()
            if not self._step_run.finished.is_set():
                self._step_run.abandon()
        _log.error("%s", text)

    def _wait_for(self, run: Run) -> None:
        """Wait for a run to end; if it takes too long, abandon it."""
        if not run.finished.wait(STUCK):
            self._abandon(run)
        if run.is_own and not run.abandoned:
            run.thread.join(STUCK)  # the thread is about to end

    def _stop_controllers(self, controllers: list[SimpleController]) -> None:
        """Stop controllers on a separate thread, which can be abandoned if a controller does not return."""
        self._stop_run = Run.on_own_thread(
            lambda run: self._end_stopping(run, self.world.stop_controllers(run, controllers))
        )
        self._stop_run.thread.start()
        self._wait_for(self._stop_run)

    def _main(self, run: Run, last_step: int | None) -> None:
        """Initialize the controllers and step the world, on the run's own thread."""
        failed: ControllerError | None = None
        try:
            self.world.initialize(run)
            self._keep_pace(run, last_step)
        except BaseException as error:  # noqa: BLE001 - the thread must not end silently
            failed = error if isinstance(error, ControllerError) else self.world.controller_error(run, error)
            _log.error("%s", failed)
        sys.setswitchinterval(USUAL_INTERVAL)
        self._end(run, failed)

    def _keep_pace(self, run: Run, last_step: int | None) -> None:
        """Step so that simulated time follows real time. Delays of up to `LONGEST_DEBT` don't accumulate."""
        pace = _Pace(self.step, self.time_step)
        while not run.stopping.is_set() and (last_step is None or self.step < last_step):
            sys.setswitchinterval(SWITCH_INTERVAL)  # every time, because the end of any simulation resets the interval
            due = pace.steps_due(self.step)
            if last_step is not None:
                due = min(due, last_step - self.step)
            self.world.run_steps(run, due)
            if not run.abandoned:
                self.snapshot.put(self.world.snapshot())
            time.sleep(self.rest)


class _Pace:
    """Computes how many steps are due, and warns when the machine can't keep up."""

    def __init__(self, step: int, time_step: float) -> None:
        self._time_step = time_step
        self._origin = time.perf_counter() - step * time_step  # the time of step 0, without delays
        self._lost, self._since = 0.0, time.perf_counter()  # [s] skipped since the last report

    def steps_due(self, step: int) -> int:
        """Return how many steps to take now if ``step`` steps have been taken so far."""
        now = time.perf_counter()
        debt = now - self._origin - step * self._time_step
        if debt > LONGEST_DEBT:
            self._origin += debt - LONGEST_DEBT
            self._lost += debt - LONGEST_DEBT
            debt = LONGEST_DEBT
        if now - self._since > REPORT_EVERY:
            ratio = 1.0 - self._lost / (now - self._since)
            if ratio < SLOW:
                _log.warning("this machine can't keep up: the simulation runs at %.2f times real time", ratio)
            self._lost, self._since = 0.0, now
        return int(min(debt, LONGEST_BATCH) / self._time_step)
