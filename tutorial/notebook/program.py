"""A project's program in the kernel, with its 3D view in a cell."""

import asyncio
import math
import time
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TypeVar

from IPython.display import display
from ipywidgets import FloatProgress

from tutorial.body import Body
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError, did_you_mean
from tutorial.notebook.widgets.cell_widget import CellWidget
from tutorial.notebook.widgets.scene_view import SceneView
from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.program.run import FRAME
from tutorial.simulation import REST, Simulation
from tutorial.trace import HandoffTrace
from tutorial.view.bodies import View
from tutorial.view.replay import recorded
from tutorial.view.scene import Scene

T = TypeVar("T")

LONG_REST = 0.05  # [s] between batches of steps while no page is open, to save CPU time
REST_AFTER = 300.0  # [s] without an open page before a running simulation is paused
RESTS = "paused at %.1f s, after %d min without an open page: call start() to resume"
LONGEST_PAUSE = 1.0  # [s]; replays shorten longer pauses to this length


class EndedEarly(TutorialError):  # noqa: N818 - it ends a cell, and is not an error
    """Raised when a run is interrupted. The program stays open and can be run again."""


class Program:
    """A project that runs in this kernel, as with ``tank run`` in a terminal. Use it on the kernel's main thread.

    The view follows the bodies between cells, and while a cell awaits something.

    Args:
        project: the project to run.
        node: the name of its ROS 2 node.

    Attributes:
        host: the node, the bodies and the controllers.
        view: the 3D view. To show it, put it on a cell's last line, in as many cells as you like.
        trace: when each message was received, posted and applied, and on which thread.
    """

    def __init__(self, project: Project, node: str = "tank") -> None:
        self._name = node
        self._scene = scene = Scene()
        self.trace = HandoffTrace()
        self._drawing = View(scene)
        self.host = Host(project, ["--ros-args", "-r", f"__node:={node}"], self._drawing, self.trace)
        self.view = SceneView(scene, title=node)
        self._running = False
        self._open = True
        self._started_at = math.inf
        self._next = asyncio.get_running_loop().call_later(FRAME, self._draw)

    def __repr__(self) -> str:
        state = f"bodies={list(self.host.bodies)}" if self._open else "closed"
        return f"Program({self._name!r}, {state})"

    @property
    def simulation(self) -> Simulation:
        """The simulated copy of the world.

        Raises:
            TutorialError: the program has no simulation.
        """
        if self.host.simulation is None:
            raise TutorialError("this program does not simulate: its project has no 'simulator'.")
        return self.host.simulation

    @property
    def received(self) -> int:
        """The number of messages whose callbacks have returned."""
        return self.trace.handled

    @property
    def waiting(self) -> int:
        """The number of posted calls that are waiting for the main thread."""
        return self.host.waiting

    @property
    def error(self) -> BaseException | None:
        """The last exception from a callback or the simulation since the last start; None if there was none."""
        return self.host.error

    def body(self, name: str = "Tank") -> Body:
        """Find a displayed body.

        Raises:
            TutorialError: the program has no such body.
        """
        return _find(name, self.host.bodies, "body")

    def controller(self, name: str) -> SimpleController:
        """Find a controller by its class name.

        Raises:
            TutorialError: the program has no such controller.
        """
        return _find(name, self.host.controllers, "controller")

    def start(self) -> None:
        """Run the simulation in real time until `stop` is called. Idempotent.

        If the notebook has no open page for a few minutes, the simulation is paused, and a note below the view says so.

        Raises:
            TutorialError: the program has no simulation, or was closed.
        """
        self._check_open()
        if not self.simulation.running:
            self.host.forget_errors()
            self.simulation.start()
        self._started_at = time.monotonic()

    def stop(self) -> None:
        """Stop the simulation that `start` started. Idempotent.

        Raises:
            TutorialError: the program has no simulation.
        """
        self._started_at = math.inf
        self.simulation.stop()

    def advance(self, seconds: float) -> None:
        """Stop a simulation that runs in real time, and simulate as fast as the machine can.

        Successive calls form one run: the controllers keep their state.

        Args:
            seconds: the simulated time to advance by [s].

        Raises:
            ControllerError: a controller raised an exception.
            TutorialError: the program has no simulation, or was closed.
        """
        self._check_open()
        if self.simulation.running:
            self.stop()
        self.host.forget_errors()
        self.simulation.advance(seconds)

    async def run(self, seconds: float) -> None:
        """Run in real time, with a progress bar. Interrupt the kernel to stop early.

        Args:
            seconds: the duration [s], in simulated time if the program simulates.

        Raises:
            ControllerError: a controller raised an exception.
            EndedEarly: the kernel was interrupted.
            TutorialError: the program was closed.
        """
        self._check_open()
        if self.host.simulation is not None:
            self.host.simulation.stop()
        bar = FloatProgress(max=seconds, description=f"{seconds:g} s")
        display(bar)  # type: ignore[no-untyped-call]
        began = self.host.seconds

        def progress(now: float) -> None:
            bar.value = now - began

        self._running = True
        try:
            await self.host.run(seconds, progress=progress)
        except asyncio.CancelledError:
            bar.bar_style = "warning"
            raise EndedEarly(f"after {bar.value:.1f} s") from None
        finally:
            self._running = False
        bar.value, bar.bar_style = seconds, "success"

    def show_frames(self, *names: str) -> None:
        """Draw the axes of frames in the view, as rviz2 does: x red, y green, z blue. The X key also does this.

        Args:
            names: frames such as ``"odom"`` and ``"Tank/base_link"``; without names, all frames.

        Raises:
            TutorialError: there is no such frame, or the program was closed.
        """
        self._check_open()
        self._drawing.show_frames(*(names or self._drawing.frame_names))
        self._drawing.flush()

    def hide_frames(self) -> None:
        """Hide the axes of all frames.

        Raises:
            TutorialError: the program was closed.
        """
        self._check_open()
        self._drawing.show_frames()
        self._drawing.flush()

    def record(self, path: Path | str) -> AbstractContextManager[None]:
        """Write a page that replays what the view shows during a ``with`` block, for instance::

            with tank.record("drive.html"):
                await tank.run(10)

        The page needs no other files: you can send it to a friend. Pauses without movement are shortened to at most one
        second.

        Args:
            path: where to write the page.

        Raises:
            TutorialError: the file cannot be written, or the program was closed.
        """
        self._check_open()
        shown = (self.host.node.get_name(), self.host.shown_at, self.host.joint_positions)
        return recorded(self._scene, path, *shown, LONGEST_PAUSE)

    def close(self) -> None:
        """Shut down the simulation, controllers and node. The view keeps its last frame. Idempotent."""
        self._open = False
        self._next.cancel()
        self.host.close()
        self._scene.catch_up()  # so that pages opened later also show the last frame
        self._scene.catch_up = lambda: None
        self.view.end()

    def _check_open(self) -> None:
        if not self._open:
            raise TutorialError("this program is closed. Run the cell with open_program again.")

    def _draw(self) -> None:
        """Refresh the view outside `run`, and schedule the next refresh.

        While the page is gone, refresh and simulate at longer intervals, and after `REST_AFTER` stop the simulation. If
        no page has been opened yet, the simulation continues.
        """
        is_gone = CellWidget.page_is_gone()
        self._next = asyncio.get_running_loop().call_later(1.0 if is_gone else FRAME, self._draw)
        if self.host.simulation is not None:
            self.simulation.rest = LONG_REST if is_gone else REST
        if not self._running:
            gone_for = time.monotonic() - max(CellWidget.heard_at, self._started_at)
            if gone_for > REST_AFTER and self.simulation.running:
                self.host.note = RESTS % (self.simulation.time, gone_for / 60)
                self.stop()
            self.host.refresh()


def _find(name: str, things: dict[str, T], what: str) -> T:
    if name not in things:
        raise TutorialError(f"this program has no {what} {name!r}.{did_you_mean(name, things)}")
    return things[name]
