"""A project's program within the kernel, and its 3D view in a cell."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, TypeVar

from IPython.display import display
from ipywidgets import FloatProgress

from tutorial.errors import TutorialError, did_you_mean
from tutorial.host import FRAME, Host
from tutorial.scene import Scene
from tutorial.trace import HandoffTrace
from tutorial.view import View
from tutorial.widgets.scene_view import SceneView

if TYPE_CHECKING:
    from tutorial.body import Body
    from tutorial.controller import SimpleController
    from tutorial.project import Project
    from tutorial.simulation import Simulation

__all__ = ["Program"]

T = TypeVar("T")


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
        scene = Scene()
        self.trace = HandoffTrace()
        self.host = Host(project, ["--ros-args", "-r", f"__node:={node}"], View(scene), self.trace)
        self.view = SceneView(scene, title=node)
        self._running = False
        self._loop = asyncio.get_running_loop()
        self._next = self._loop.call_later(FRAME, self._draw)

    def __repr__(self) -> str:
        return f"Program({self.host.node.get_name()!r}, bodies={list(self.host.bodies)})"

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
    def error(self) -> Exception | None:
        """What a callback or the simulation raised last; None when nothing did."""
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

    async def run(self, seconds: float) -> None:
        """Run for a while, in real time, with a progress bar; to interrupt the kernel stops it.

        Args:
            seconds: how long [s]; simulated time where the program simulates.

        Raises:
            ControllerError: a controller raised an exception.
        """
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
            raise
        finally:
            self._running = False
        bar.value, bar.bar_style = seconds, "success"

    def close(self) -> None:
        """End the program: its simulation, its controllers, its node. Its last picture stays. Idempotent."""
        self._next.cancel()
        self.host.close()
        self.view.end()

    def _draw(self) -> None:
        """Draw what happens outside of `run`, again and again."""
        self._next = self._loop.call_later(FRAME, self._draw)
        if not self._running:
            self.host.refresh()


def _find(name: str, things: dict[str, T], what: str) -> T:
    if name not in things:
        raise TutorialError(f"this program has no {what} {name!r}.{did_you_mean(name, things)}")
    return things[name]
