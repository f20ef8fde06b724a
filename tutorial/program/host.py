"""One running program: a node, a main loop, the bodies of a project with their controllers, and a view of them."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractAsyncContextManager
from typing import TYPE_CHECKING, Any

from tutorial.body import Body
from tutorial.controller import SimpleController
from tutorial.errors import RefusedError, TutorialError, did_you_mean
from tutorial.handoff import PATIENCE, CallQueue
from tutorial.program.frame import draw_frame
from tutorial.program.item import Item
from tutorial.program.neighbours import Neighbours
from tutorial.program.record import make_record
from tutorial.program.run import FRAME, DisplayedRun, SimulatedRun
from tutorial.ros.clock_publisher import ClockPublisher
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import Simulation, State
from tutorial.view.camera import CameraRenderer

if TYPE_CHECKING:
    from tutorial.program.project import BodyItem, Project
    from tutorial.trace import HandoffTrace
    from tutorial.view.bodies import View

CLOSED = "this program is closed. Open it again."
NO_SIMULATION = (
    "this program has no simulation, or has not created it yet. For a simulation, the project needs a 'simulator'."
)

_log = logging.getLogger(__name__)


class Host(AbstractAsyncContextManager["Host"]):
    """A program that runs a project: it simulates the bodies or, if the project has no simulator, only displays them.

    Create and use it on the main thread, whose event loop must be running. Use ``async with Host(project)`` in a
    notebook cell, or in a coroutine that a script passes to `asyncio.run`.

    Args:
        project: the project to run.
        ros_args: command line arguments; ROS 2 reads those after ``--ros-args``. The node is called ``tank`` unless it
            is remapped.
        view: the view, which is drawn only while its scene is watched; None to show nothing.
        trace: the trace that records when each message is received, posted and applied; None to record nothing.

    Attributes:
        simulation: the simulation; None if the program has none.
        node: the program's node.
        note: text at the start of the line below the view, until the next run.

    Raises:
        TutorialError: a controller does not fit its body or, at the end of the context, failed in ``unconfigure``.
    """

    def __init__(
        self,
        project: Project,
        ros_args: Sequence[str] | None = None,
        view: View | None = None,
        trace: HandoffTrace | None = None,
    ) -> None:
        self.note = ""
        self.simulation: Simulation | None = None
        self._closed = False
        self._items: dict[str, Item] = {}
        self._last_run: DisplayedRun | None = None  # stays None if the program runs a simulation
        self._snapshot_time = 0.0  # simulated time of the snapshot that the displayed bodies show [s]
        self._calls = CallQueue(asyncio.get_running_loop(), trace)
        self._cameras = CameraRenderer()
        self._ros = NodeThread("tank", ros_args, trace)
        self.node = self._ros.node
        self._neighbours = Neighbours(self._ros, project.clock)
        self._view = view
        if view is not None:
            view.scene.catch_up = self._draw
        try:
            clock: list[tuple[str, SimpleController]] = [("", ClockPublisher(self.node))] if project.clock else []
            for entry in project.bodies:  # messages arrive from now on; calls posted for them wait for the event loop
                self._add(entry, simulates=project.time_step is not None)
            # Zoom in on the bodies, unless there are several and one of them, such as a laboratory, has no controllers.
            if view is not None and (len(self._items) == 1 or all(entry.controllers for entry in project.bodies)):
                view.look_at_bodies(*self._items)
            if project.time_step is not None:
                placements = [entry.placement for entry in project.bodies]
                controllers = [(name, each) for name, item in self._items.items() for each in item.controllers]
                self.simulation = Simulation(placements, clock + controllers, project.time_step, self._cameras.camera)
        except BaseException:
            self.close()
            raise

    async def __aexit__(self, kind: object, *_: object) -> None:
        self.close()
        ends_well = kind in (None, asyncio.CancelledError)  # a new error must not mask any other error
        if ends_well and any(item.failed for item in self._items.values()):
            raise TutorialError("a controller failed in unconfigure(). The log shows where.")

    async def run(
        self, duration: float | None = None, linger: float = 0.0, progress: Callable[[float], object] | None = None
    ) -> None:
        """Run the program. The event loop stays free, so posted calls run and the view is drawn in the meantime.

        Args:
            duration: how long to run [s], in simulated time if the project simulates; None to run until cancelled.
            linger: if the program has no simulation, the maximum time to wait, after the duration, for the publishers
                to leave and for their messages to be applied [s].
            progress: called with `seconds` once per frame.

        Raises:
            ControllerError: a controller raised an exception or did not return; in both cases, the simulation has
                stopped.
            TutorialError: the program is closed.
        """
        if self._closed:
            raise TutorialError(CLOSED)
        due = time.monotonic()
        self.forget_errors()
        run = self._begin_run(duration, linger)
        try:
            while not (self._closed or run.is_over()):
                self.refresh()
                if progress is not None:
                    progress(self.seconds)
                due = max(due + FRAME, time.monotonic())  # at a fixed rate, unless drawing takes longer than a frame
                await asyncio.sleep(due - time.monotonic())
        finally:
            if self.simulation is not None:
                self.simulation.stop()
            self.refresh()
        if self.simulation is not None and self.simulation.error is not None:
            raise self.simulation.error

    def refresh(self) -> None:
        """Show the changes since the last frame. `run` calls this method; call it yourself when no run is active."""
        if self._closed:
            return
        self._neighbours.check()
        if self.simulation is not None:
            self._snapshot_time = self.simulation.copy_to(self.bodies.values())
        if self._view is not None and self._view.scene.watched:
            self._draw()

    def add(self, entry: BodyItem) -> None:
        """Add a body with its controllers to a program without a simulation.

        Raises:
            TutorialError: the program simulates or is closed, a body with this name already exists, or a controller
                does not fit the body. In each case, the body is not added.
        """
        name = entry.placement.name
        if self._closed:
            raise TutorialError(CLOSED)
        if self.simulation is not None:
            raise TutorialError(f"{name!r} cannot join a simulation. Add it to the project and reopen the project.")
        if name in self._items:
            raise TutorialError(f"there is already a body {name!r}. Remove it first, or rename the new body.")
        try:
            self._add(entry, simulates=False)
        except BaseException:
            if name in self._items:
                self.remove(name)
            raise

    def remove(self, name: str) -> None:
        """Detach a body's controllers, cancel their waiting calls, and remove the body from the program.

        If the body is simulated, its copy remains in the simulated world. Earlier errors, except the simulation's, are
        cleared, because the removed body may have caused them.

        Raises:
            ControllerError: a controller did not return; the body is removed anyway.
            TutorialError: there is no such body.
        """
        if name not in self._items:
            raise TutorialError(f"there is no body {name!r}.{did_you_mean(name, self._items)}")
        self._items[name].drop_calls()  # first, so that no request is carried out after its controller has stopped
        try:
            if self.simulation is not None and self.simulation.state is not State.ABANDONED:
                self.simulation.release(name)
        finally:
            with self._ros.paused():  # as in `close`
                self._items.pop(name).close()
            self.forget_errors()
            if self._view is not None:
                self._view.remove(name)

    def close(self) -> None:
        """Shut down the simulation, controllers and node. Idempotent; call it again if Ctrl-C interrupts it."""
        self._closed = True
        try:
            if self.simulation is not None:
                self.simulation.stop()
        finally:
            self._cameras.close()
            with self._ros.paused():  # waits until callbacks whose requests were refused have responded
                for item in self._items.values():
                    item.close()
            self._calls.close()
            self._ros.close()

    @property
    def bodies(self) -> dict[str, Body]:
        """The displayed bodies by name."""
        return {name: item.body for name, item in self._items.items()}

    @property
    def controllers(self) -> dict[str, SimpleController]:
        """The controllers of all bodies by class name; the last one if several have the same name."""
        return {type(c).__name__: c for item in self._items.values() for c in item.controllers}

    @property
    def waiting(self) -> int:
        """The number of posted calls that are waiting for the main thread."""
        return len(self._calls)

    @property
    def seconds(self) -> float:
        """Simulated time [s]; if the program has no simulation, the duration of its current or last run."""
        if self.simulation is not None:
            return self.simulation.time
        return self._last_run.seconds if self._last_run is not None else 0.0

    @property
    def error(self) -> BaseException | None:
        """The last error since the last start.

        The simulation's error takes precedence over errors from callbacks, cameras and posted calls.
        """
        simulated = self.simulation.error if self.simulation is not None else None
        return simulated or self._ros.error or self._cameras.error or self._calls.error

    def forget_errors(self) -> None:
        """Clear the note and all errors except the simulation's. `run` calls this method first. Main thread only."""
        self.note = ""
        self._ros.error = self._cameras.error = self._calls.error = None

    def shown_at(self) -> float:
        """Return the time of the displayed state [s]: simulated time, or `time.monotonic` if nothing is simulated."""
        return self._snapshot_time if self.simulation is not None else time.monotonic()

    def joint_positions(self) -> dict[str, float]:
        """Return the positions of the displayed joints [rad, or m for slide joints], keyed by ``"body joint"``."""
        return {f"{name} {joint.name}": joint.position for name, body in self.bodies.items() for joint in body.joints}

    def record(self) -> dict[str, Any]:
        """Return a summary of the run for the current bodies. See `tutorial.program.record`."""
        return make_record(self.node.get_name(), self.seconds, self.node.meters, list(self._items.values()))

    def _add(self, entry: BodyItem, simulates: bool) -> None:
        """Add a body to the program and the view, and attach the body's controllers."""
        name = entry.placement.name
        item = self._items[name] = Item(entry.placement, self.node, self._calls, self._ask)
        if self._view is not None:
            self._view.add(name, item.body.model)
        for controller in entry.controllers:
            item.attach(controller)
            if not simulates and controller.control is not SimpleController.control:
                _log.warning("%s.control is never called: this project has no 'simulator'", controller.__name__)

    def _ask(self, function: Callable[..., Any], /, *args: object, timeout: float = PATIENCE) -> Any:
        """Have the simulation's thread run a function.

        Refuse the request if there is no simulation yet: controllers are attached before the simulation is created.
        """
        if self.simulation is None:
            raise RefusedError(NO_SIMULATION)
        return self.simulation.world.requests.ask(function, *args, timeout=timeout)

    def _begin_run(self, duration: float | None, linger: float) -> SimulatedRun | DisplayedRun:
        if self.simulation is None:
            self._last_run = DisplayedRun(self.node, self._calls, duration, linger)
            return self._last_run
        self.simulation.start(duration)
        return SimulatedRun(self.simulation, duration is not None)

    def _draw(self) -> None:
        if self._view is not None:
            draw_frame(self._view, self._items, self.note, self.error)
