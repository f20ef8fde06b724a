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
from tutorial.errors import TutorialError, did_you_mean
from tutorial.handoff import CallQueue
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

_log = logging.getLogger(__name__)


class Host(AbstractAsyncContextManager["Host"]):
    """A program that runs a project: it simulates, or displays, as the project says.

    It belongs to the thread that makes it, the main thread, whose event loop must be running: ``async with
    Host(project)`` in a script's `asyncio.run`, or in a notebook's cell.

    Args:
        project: what to run.
        ros_args: command line arguments, of which ROS 2 takes those after ``--ros-args``. The node is called ``tank``
            unless it is remapped.
        view: where to draw, while its scene is watched; None to show nothing.
        trace: where to write down when each message is received, posted and applied; None for nowhere.

    Attributes:
        simulation: the simulated copy of the bodies, or None for a program that only displays.
        node: the program's node.
        note: what comes first below the view, until the next start.

    Raises:
        TutorialError: a controller does not fit its body. When the context ends: one failed to leave it.
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
        self._displayed: DisplayedRun | None = None  # the last run of a program that only displays
        self._shown = 0.0  # simulated time of what is displayed [s]
        self._calls = CallQueue(asyncio.get_running_loop(), trace)
        self._cameras = CameraRenderer()
        self._ros = NodeThread("tank", ros_args, trace)
        self.node = self._ros.node
        self._neighbours = Neighbours(self._ros, project.clock)
        self._view = view
        if view is not None:
            view.scene.catch_up = self._draw
        try:
            clock = [ClockPublisher(self.node)] if project.clock else []
            for entry in project.bodies:  # messages come from now on, and wait until the loop runs
                self._show(entry, project.time_step is not None)
            # Robots alone fill the picture. With other bodies, such as a laboratory, it shows where robots move.
            if view is not None and (len(self._items) == 1 or all(entry.controllers for entry in project.bodies)):
                view.look_at_bodies(*self._items)
            if project.time_step is not None:
                placements = [entry.placement for entry in project.bodies]
                controllers: list[tuple[str, SimpleController]] = [("", each) for each in clock]
                controllers += [(name, each) for name, item in self._items.items() for each in item.controllers]
                self.simulation = Simulation(placements, controllers, project.time_step, self._cameras.camera)
        except BaseException:
            self.close()
            raise

    async def __aexit__(self, kind: object, *_: object) -> None:
        self.close()
        if kind in (None, asyncio.CancelledError) and any(item.failed for item in self._items.values()):
            raise TutorialError("a controller has failed in unconfigure(): the log says where.")

    async def run(
        self, duration: float | None = None, linger: float = 0.0, progress: Callable[[float], object] | None = None
    ) -> None:
        """Run for a while. The event loop stays free: posted calls run, and the view is drawn, meanwhile.

        Args:
            duration: how long [s], in simulated time where the project simulates; None to go on until cancelled.
            linger: the longest wait after the duration [s], where the program only displays: for the publishers to go
                and their messages to be shown.
            progress: called with the seconds that have passed, about as often as a frame is drawn.

        Raises:
            ControllerError: a controller raised an exception, or does not return; the simulation has stopped.
            TutorialError: it was closed.
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
                due = max(due + FRAME, time.monotonic())  # by schedule, so that drawing costs no frames
                await asyncio.sleep(due - time.monotonic())
        finally:
            if self.simulation is not None:
                self.simulation.stop()
            self.refresh()
        if self.simulation is not None and self.simulation.error is not None:
            raise self.simulation.error

    def refresh(self) -> None:
        """Show what has changed since the last frame. `run` does it; call it when nothing runs."""
        if self._closed:
            return
        self._neighbours.check()
        if self.simulation is not None:
            self._shown = self.simulation.copy_to(self.bodies.values())
        if self._view is not None and self._view.scene.watched:
            self._draw()

    def add(self, entry: BodyItem) -> None:
        """Show one more body, with its controllers, in a program that only displays.

        Raises:
            TutorialError: the program simulates, or was closed; there is a body of this name; or a controller does not
                fit its body, which then is not there.
        """
        name = entry.placement.name
        if self._closed:
            raise TutorialError(CLOSED)
        if self.simulation is not None:
            raise TutorialError(f"{name!r} comes too late: a simulated world is made of the bodies in its project.")
        if name in self._items:
            raise TutorialError(f"there is a body {name!r} already. Remove it first, or give this one another name.")
        try:
            self._show(entry, simulates=False)
        except BaseException:
            if name in self._items:
                self.remove(name)
            raise

    def remove(self, name: str) -> None:
        """Delete a displayed body: its controllers leave it, and what they have posted does not run any more.

        This forgets earlier errors, because the next body may be without the fault.

        Raises:
            ControllerError: a controller does not return; the body is removed all the same.
            TutorialError: there is no such body.
        """
        if name not in self._items:
            raise TutorialError(f"there is no body {name!r}.{did_you_mean(name, self._items)}")
        try:
            if self.simulation is not None and self.simulation.state is not State.ABANDONED:
                self.simulation.release(name)
        finally:
            self._items.pop(name).close()
            self.forget_errors()
            if self._view is not None:
                self._view.remove(name)

    def close(self) -> None:
        """End the simulation, the controllers and the node. Idempotent; goes on where it was interrupted."""
        self._closed = True
        try:
            if self.simulation is not None:
                self.simulation.stop()
        finally:
            self._cameras.close()
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
        """The controllers of all bodies by the names of their classes; of several with one name, the last."""
        return {type(c).__name__: c for item in self._items.values() for c in item.controllers}

    @property
    def waiting(self) -> int:
        """How many posted calls wait for the main thread."""
        return len(self._calls)

    @property
    def seconds(self) -> float:
        """How long the program has run [s]: simulated time where it simulates."""
        if self.simulation is not None:
            return self.simulation.time
        return self._displayed.seconds if self._displayed is not None else 0.0

    @property
    def error(self) -> BaseException | None:
        """What the simulation, a callback or a posted call raised last since the last start; None when nothing did."""
        others = self._ros.error or self._cameras.error or self._calls.error
        return (self.simulation and self.simulation.error) or others

    def forget_errors(self) -> None:
        """Forget the note, and what callbacks and posted calls raised before. `run` does it. Main thread."""
        self.note = ""
        self._ros.error = self._cameras.error = self._calls.error = None

    def shown_at(self) -> float:
        """The time of what the view shows [s]: simulated time where it simulates, else of `time.monotonic`."""
        return self._shown if self.simulation is not None else time.monotonic()

    def joint_positions(self) -> dict[str, float]:
        """Where the displayed joints are [rad], or [m] for those that slide, by ``"body joint"``."""
        return {f"{name} {joint.name}": joint.position for name, body in self.bodies.items() for joint in body.joints}

    def record(self) -> dict[str, Any]:
        """Sum the run up, for the bodies that are there. See `tutorial.program.record`."""
        return make_record(self.node.get_name(), self.seconds, self.node.meters, list(self._items.values()))

    def _show(self, entry: BodyItem, simulates: bool) -> None:
        """Display a body, and have its controllers join it."""
        name = entry.placement.name
        item = self._items[name] = Item(entry.placement, self.node, self._calls)
        if self._view is not None:
            self._view.add(name, item.body.model)
        for controller in entry.controllers:
            item.attach(controller)
            if not simulates and controller.control is not SimpleController.control:
                _log.warning("%s.control is never called: this project has no 'simulator'", controller.__name__)

    def _begin_run(self, duration: float | None, linger: float) -> SimulatedRun | DisplayedRun:
        if self.simulation is None:
            self._displayed = DisplayedRun(self.node, self._calls, duration, linger)
            return self._displayed
        self.simulation.start(duration)
        return SimulatedRun(self.simulation, duration is not None)

    def _draw(self) -> None:
        if self._view is not None:
            draw_frame(self._view, self._items, self.note, self.error)
