"""A project's program within the kernel, and its 3D view in a cell."""

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

LONG_REST = 0.05  # [s] between two batches of steps while the page is gone: longer ones take less of the processor
REST_AFTER = 300.0  # [s] without a page, after which a simulation that was started rests
RESTS = "paused at %.1f s, after %d min without a page: start() goes on"
LONGEST_PAUSE = 1.0  # [s] in a replay: between two cells, one thinks


class EndedEarly(TutorialError):  # noqa: N818 - it is no error, but the end of a cell
    """A run was interrupted. The program goes on, and can be run again."""


class Program:
    """One program: what ``tank run`` is at a terminal, within this kernel. It belongs to the kernel's main thread.

    Its displayed bodies follow what happens, between the cells and while one awaits something.

    Args:
        project: what to run.
        node: what its ROS 2 node is called.

    Attributes:
        host: the node, the bodies and the controllers.
        view: the 3D view. As the last line of a cell it is shown; as often as wished.
        trace: when each message was received, posted and applied, and on which thread.
    """

    def __init__(self, project: Project, node: str = "tank") -> None:
        self._name = node
        self._scene = scene = Scene()
        self.trace = HandoffTrace()
        self.host = Host(project, ["--ros-args", "-r", f"__node:={node}"], View(scene), self.trace)
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
            TutorialError: the program only displays.
        """
        if self.host.simulation is None:
            raise TutorialError("this program only displays: its project has no 'simulator'.")
        return self.host.simulation

    @property
    def received(self) -> int:
        """How many messages' callbacks have returned."""
        return self.trace.handled

    @property
    def waiting(self) -> int:
        """How many posted calls wait for the main thread."""
        return self.host.waiting

    @property
    def error(self) -> BaseException | None:
        """What a callback or the simulation raised last since the last start; None when nothing did."""
        return self.host.error

    def body(self, name: str = "Tank") -> Body:
        """Find a displayed body.

        Raises:
            TutorialError: there is none of this name.
        """
        return _find(name, self.host.bodies, "body")

    def controller(self, name: str) -> SimpleController:
        """Find a controller by the name of its class.

        Raises:
            TutorialError: there is none of this name.
        """
        return _find(name, self.host.controllers, "controller")

    def start(self) -> None:
        """Let simulated time pass, in real time, until `stop`. When it does already, nothing happens.

        If the notebook's page is gone for some minutes, time stands still, and the view says so.

        Raises:
            TutorialError: the program only displays, or was closed.
        """
        self._check_open()
        if not self.simulation.running:
            self.host.forget_errors()
            self.simulation.start()
        self._started_at = time.monotonic()

    def stop(self) -> None:
        """Let simulated time stand still. Idempotent.

        Raises:
            TutorialError: the program only displays.
        """
        self._started_at = math.inf
        self.simulation.stop()

    def advance(self, seconds: float) -> None:
        """Let simulated time pass as fast as the machine can; real time is stopped first.

        One after the other they are one run: the controllers go on where they were.

        Args:
            seconds: how much [s].

        Raises:
            ControllerError: a controller raised an exception.
            TutorialError: the program only displays, or was closed.
        """
        self._check_open()
        if self.simulation.running:
            self.stop()
        self.host.forget_errors()
        self.simulation.advance(seconds)

    async def run(self, seconds: float) -> None:
        """Run for a while, in real time, with a progress bar; to interrupt the kernel stops it.

        Args:
            seconds: how long [s]; simulated time where the program simulates.

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

    def record(self, path: Path | str) -> AbstractContextManager[None]:
        """Keep what the view shows, while a ``with`` block runs, as a page that plays it again, for instance::

            with tank.record("drive.html"):
                await tank.run(10)

        The page needs nothing else: it can be sent to a friend. A time in which nothing moves counts a second at most.

        Args:
            path: of the page.

        Raises:
            TutorialError: the file cannot be written, or the program was closed.
        """
        self._check_open()
        shown = (self.host.node.get_name(), self.host.shown_at, self.host.joint_positions)
        return recorded(self._scene, path, *shown, LONGEST_PAUSE)

    def close(self) -> None:
        """End the program: its simulation, its controllers, its node. Its last picture stays. Idempotent."""
        self._open = False
        self._next.cancel()
        self.host.close()
        self._scene.catch_up()  # the last picture, also for a page that comes later
        self._scene.catch_up = lambda: None
        self.view.end()

    def _check_open(self) -> None:
        if not self._open:
            raise TutorialError("this program is closed. Run the cell with open_program again.")

    def _draw(self) -> None:
        """Draw what happens outside of `run`, again and again.

        While the page is gone, all takes less; if it is gone for long, a simulation that goes on is stopped. Without
        any page so far, it goes on.
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
