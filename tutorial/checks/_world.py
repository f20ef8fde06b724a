"""A simulated body with the learner's controller, stepped in lockstep with the messages it gets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from tutorial.body import Body
from tutorial.checks._node import CheckThread
from tutorial.checks._watch import Failure, watch
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.paths import HOME
from tutorial.simulation import ControllerError, Simulation
from tutorial.world import Placement

__all__ = ["MODELS", "Moment", "Stage", "Watched", "World"]

MODELS: Path = HOME / "project" / "models"


@dataclass(frozen=True)
class Moment:
    """What was true when a message was published.

    Attributes:
        step: the simulation's.
        time_ns: simulated time [ns].
        joints: by name, the joint's position, velocity and effort.
    """

    step: int
    time_ns: int
    joints: dict[str, dict[str, float]]


class Watched(SimpleController):
    """The learner's controller, each call of which is watched.

    Args:
        controller_class: the learner's class.

    Attributes:
        inner: the learner's controller.
        io: what it was initialized with.
    """

    def __init__(self, controller_class: type[SimpleController]) -> None:
        self.io: ControllerIO | None = None
        with watch.call("__init__"):
            self.inner = controller_class()

    def configure(self, config: ControllerConfig) -> None:
        """Pass the call on."""
        with watch.call("configure"):
            self.inner.configure(config)

    def initialize(self, io: ControllerIO) -> None:
        """Pass the call on."""
        self.io = io
        with watch.call("initialize"):
            self.inner.initialize(io)

    def control(self) -> None:
        """Pass the call on."""
        with watch.call("control"):
            self.inner.control()

    def stop(self) -> None:
        """Pass the call on."""
        with watch.call("stop"):
            self.inner.stop()

    def unconfigure(self) -> None:
        """Pass the call on."""
        with watch.call("unconfigure"):
            self.inner.unconfigure()


class Stage:
    """A body with the learner's controller, which joins it when ``with`` begins.

    Attributes:
        ros: the nodes.
        learner: the learner's controller.
    """

    ros: CheckThread
    learner: Watched

    def __enter__(self) -> Self:
        self.ros = CheckThread()
        self.ros.node.moment = self.moment
        try:
            self.join()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def join(self) -> None:
        """Have the learner's controller join the body."""
        self.learner.configure(self.config())

    def config(self) -> ControllerConfig:
        """Return what the controller is given."""
        raise NotImplementedError

    def moment(self) -> Moment | None:
        """Return what is to be kept with a message that is published now: nothing, where nothing is simulated."""
        return None

    def close(self) -> None:
        """End the nodes.

        Raises:
            Failure: a timer of the learner's has raised.
        """
        self.ros.close()


class World(Stage):
    """A simulated world with one body, whose controller is the learner's. Time goes on only in `advance`.

    Args:
        controller_class: the learner's class.
        model: the body's model file, without ``.xml``.
        name: the body's name.
        time_step: of the simulation [s].
        before: controllers that come before the learner's, at every step.

    Attributes:
        simulation: the simulated world.
        body: the simulated body.
        displayed: the displayed body.
    """

    def __init__(
        self,
        controller_class: type[SimpleController],
        model: str = "tank",
        name: str = "Tank",
        time_step: float = 0.001,
        before: Sequence[SimpleController] = (),
    ) -> None:
        placement = Placement(name, MODELS / f"{model}.xml")
        self.displayed = Body.displayed(placement)
        self.learner = Watched(controller_class)
        self.simulation = Simulation([placement], [(name, each) for each in (*before, self.learner)], time_step)
        self.body = self.simulation.bodies[name]

    def config(self) -> ControllerConfig:
        """Return what the controller is given: posted calls are dropped, for nothing is displayed."""
        return ControllerConfig(self.displayed, self.ros.node, _drop, _drop)

    def leave(self) -> None:
        """Take the learner's controller off the body.

        Raises:
            Failure: one of the learner's methods raised.
        """
        self.simulation.release(self.body.name)
        self.learner.unconfigure()

    def advance(self, steps: int = 1) -> None:
        """Simulate so many steps.

        Raises:
            Failure: one of the learner's methods raised.
        """
        try:
            self.simulation.advance(steps * self.simulation.time_step)
        except ControllerError as error:
            if isinstance(error.__cause__, Failure):
                raise error.__cause__ from None
            raise

    def restart(self) -> None:
        """Begin anew at time 0, with the same controllers."""
        self.simulation.restart()

    def moment(self) -> Moment:
        """Return what is true now."""
        io = self.learner.io
        fields = ("position", "velocity", "effort")
        joints = {joint.name: {field: getattr(joint, field) for field in fields} for joint in self.body.joints}
        return Moment(io.step if io else 0, io.time_ns if io else 0, joints)


def _drop(*_: object) -> None:
    pass
