"""One running program: a node, a main loop, the items of a project, and a view of them."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractAsyncContextManager
from functools import partial
from typing import TYPE_CHECKING, Any

from tutorial.body import Body
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, did_you_mean
from tutorial.handoff import CallQueue
from tutorial.item import Item
from tutorial.record import make_record
from tutorial.ros.clock_publisher import CLOCK_TOPIC, ClockPublisher
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import Simulation, State
from tutorial.view.camera import CameraRenderer

if TYPE_CHECKING:
    from tutorial.project import BodyItem, Project
    from tutorial.trace import HandoffTrace
    from tutorial.view.bodies import View

FRAME = 1 / 30  # [s] between two frames of the view
QUIET = 0.3  # [s] without a message, after which nothing more is taken to be on its way
LOOK_EVERY = 1.0  # [s] for what others in the domain do
FEW = 3  # bodies that have a line each below the view
HUNG = 5.0  # [s] without a step, after which a run that has a duration is not waited for any more
CLOSED = "this program is closed. Open it again."
NAMESAKES = (
    "there are %d nodes of the name %s, so nobody can tell them apart. Give one another name, "
    "--ros-args -r __node:=%s_2, or a ROS_DOMAIN_ID of its own"
)
CLOCKS = (
    "there are %d publishers on /clock, so whoever uses simulated time sees it jump. Let one program publish it: leave "
    "'clock: true' out of the other's project, or give it a ROS_DOMAIN_ID of its own"
)

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
        bodies: the displayed bodies by name.
        simulation: the simulated copy of them, or None for a program that only displays.
        node: the program's node.
        note: what stands first below the view, until the next start.

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
        self._calls = CallQueue(asyncio.get_running_loop(), trace)
        self._view = view
        self._items: dict[str, Item] = {}
        self.simulation: Simulation | None = None
        self._cameras = CameraRenderer()
        self._ros = NodeThread("tank", ros_args, trace)
        self.node = self._ros.node
        self._seconds = self._shown = 0.0
        self._still = 0  # for how many frames there was no step
        self._seen_step = 0
        self._looked = 0.0
        self._said: dict[str, int] = {}  # the last count for each warning's text
        self._closed = False
        self.note = ""
        if view is not None:
            view.scene.catch_up = partial(self._draw, view)
        try:
            self._clock = ClockPublisher(self.node) if project.clock else None
            for entry in project.bodies:  # messages come from now on, and wait until the loop runs
                self._show(entry, project.time_step is not None)
            if view is not None and (len(self._items) == 1 or all(entry.controllers for entry in project.bodies)):
                view.look_at_bodies(*self._items)  # robots alone; else it shows where they move, such as a laboratory
            if project.time_step is not None:
                placements = [entry.placement for entry in project.bodies]
                controllers: list[tuple[str, SimpleController]] = [("", self._clock)] if self._clock else []
                controllers += [(name, each) for name, item in self._items.items() for each in item.controllers]
                self.simulation = Simulation(placements, controllers, project.time_step, self._cameras.camera)
        except BaseException:
            self.close()
            raise

    async def __aexit__(self, kind: object, *_: object) -> None:
        self.close()
        if kind in (None, asyncio.CancelledError) and any(item.failed for item in self._items.values()):
            raise TutorialError("a controller has failed in unconfigure(): the log says where.")

    @property
    def bodies(self) -> dict[str, Body]:
        """The displayed bodies by name."""
        return {name: item.body for name, item in self._items.items()}

    @property
    def controllers(self) -> dict[str, SimpleController]:
        """The controllers of all bodies by the names of their classes; of twins, the last."""
        return {type(c).__name__: c for item in self._items.values() for c in item.controllers}

    @property
    def waiting(self) -> int:
        """How many posted calls wait for the main thread."""
        return len(self._calls)

    @property
    def error(self) -> BaseException | None:
        """What the simulation, a callback or a posted call raised last since the last start; None when nothing did."""
        others = self._ros.error or self._cameras.error or self._calls.error
        return (self.simulation and self.simulation.error) or others

    def forget_errors(self) -> None:
        """What callbacks and posted calls raised before does not count any more. `run` does it. Main thread."""
        self.note = ""
        self._ros.error = self._cameras.error = self._calls.error = None

    async def run(
        self, duration: float | None = None, linger: float = 0.0, progress: Callable[[float], object] | None = None
    ) -> None:
        """Run for a while. The event loop stays free: posted calls run, and the view is drawn, meanwhile.

        Args:
            duration: how long [s], in simulated time where the project simulates; None to go on until cancelled.
            linger: a program that displays waits, after its duration, at most so long [s] for those who publish to it
                to go, and for what they have sent to be shown.
            progress: called with the seconds that have passed, about as often as a frame is drawn.

        Raises:
            ControllerError: a controller raised an exception, or does not return; the simulation has stopped.
            TutorialError: it was closed.
        """
        if self._closed:
            raise TutorialError(CLOSED)
        self._still = 0
        began = due = time.monotonic()
        self.forget_errors()
        if self.simulation is not None:
            self.simulation.start(duration)
        try:
            while not self._over(began, duration, linger):
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

    @property
    def seconds(self) -> float:
        """How long the program has run [s]: simulated time where it simulates."""
        return self.simulation.time if self.simulation is not None else self._seconds

    def shown_at(self) -> float:
        """The time of what the view shows [s]: simulated time where it simulates, else of `time.monotonic`."""
        return self._shown if self.simulation is not None else time.monotonic()

    def joint_positions(self) -> dict[str, float]:
        """Where the displayed joints are [rad], or [m] for those that slide, by ``"body joint"``."""
        return {f"{name} {joint.name}": joint.position for name, body in self.bodies.items() for joint in body.joints}

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

        What has failed so far is forgotten, as what is shown next may be mended.

        Raises:
            ControllerError: a controller does not return; the body is gone nevertheless.
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

    def record(self) -> dict[str, Any]:
        """Sum the run up, for the bodies that are there. See `tutorial.record`."""
        return make_record(self.node.get_name(), self.seconds, self.node.meters, list(self._items.values()))

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

    def _show(self, entry: BodyItem, simulates: bool) -> None:
        """Display a body, and have its controllers join it."""
        item = self._items[entry.placement.name] = Item(entry.placement, self.node, self._calls)
        if self._view is not None:
            self._view.add(entry.placement.name, item.body.model)
        for controller in entry.controllers:
            item.attach(controller)
            if not simulates and controller.control is not SimpleController.control:
                _log.warning("%s is never asked for control: this project has no 'simulator'", controller.__name__)

    def _over(self, began: float, duration: float | None, linger: float) -> bool:
        if self._closed:
            return True
        if self.simulation is not None:
            if duration is not None and self._hangs(self.simulation):
                _log.warning("the simulation has made no step for %g s, so it is stopped", HUNG)
                self.simulation.stop()
            return not self.simulation.running
        elapsed = self._seconds = time.monotonic() - began
        if duration is None or elapsed < duration:
            return False
        return elapsed >= duration + linger or self._drained()

    def _hangs(self, simulation: Simulation) -> bool:
        """Whether there was no step for many frames; time alone does not tell, as the whole process may have slept."""
        self._still = self._still + 1 if simulation.step == self._seen_step else 0
        self._seen_step = simulation.step
        return self._still > HUNG / FRAME

    def _drained(self) -> bool:
        """Whether those who publish to this program have come and gone, and what they sent has been shown."""
        received = [meter for meter in self.node.meters if meter.direction == "received"]
        return (
            not any(self.node.count_publishers(meter.topic) for meter in received)
            and all(meter.count and meter.idle > QUIET for meter in received)
            and not len(self._calls)
        )

    def refresh(self) -> None:
        """Show what has changed since the last frame. `run` does it; call it when nothing runs."""
        if self._closed:
            return
        self._look_around()
        if self.simulation is not None:
            self._shown = self.simulation.copy_to(self.bodies.values())
        if self._view is not None and self._view.scene.watched:
            self._draw(self._view)

    def _draw(self, view: View) -> None:
        """Draw one frame."""
        for name, item in self._items.items():
            if item.take_dirty():
                view.update(name, item.body.data)
            view.show_stale(name, item.joints.stale())
        lines, readings = self._below(view)
        view.line("  |  ".join(filter(None, (self.note, self._trouble(), *lines))), readings)
        view.flush()

    def _below(self, view: View) -> tuple[list[str], list[tuple[str, ...]]]:
        """What is known of each body's messages, and what its sensors have measured.

        Of more than `FEW` bodies: how many are in order, and what is wrong with the first few others.
        """
        watches = [item.joints for item in self._items.values()]
        fleet = [watch for watch in watches if watch.meters or watch.in_order]
        if len(fleet) <= FEW:
            return [watch.line() for watch in watches], [row for name in self._items for row in view.readings(name)]
        others = [watch for watch in fleet if not watch.in_order]
        count = f"{len(fleet) - len(others)} of {len(fleet)} bodies follow their messages"
        return [count, *(watch.line() for watch in others[:FEW])], []

    def _trouble(self) -> str:
        """What stands first below the view when something of the learner's has failed."""
        error = self.error
        if error is None:
            return ""
        return str(error) if isinstance(error, TutorialError) else f"{type(error).__name__}: {error}"

    def _look_around(self) -> None:
        """Say in plain words when another node has this node's name, and when another simulation publishes its time."""
        if time.monotonic() - self._looked < LOOK_EVERY:
            return
        self._looked = time.monotonic()
        self._warn_of(NAMESAKES, self._ros.namesakes(), self.node.get_fully_qualified_name(), self.node.get_name())
        if self._clock is not None:
            self._warn_of(CLOCKS, self.node.count_publishers(CLOCK_TOPIC))

    def _warn_of(self, text: str, count: int, *names: str) -> None:
        """Say that there are several where one should be, as often as they become more."""
        if count > max(self._said.get(text, 1), 1):
            _log.warning(text, count, *names)
        self._said[text] = count
