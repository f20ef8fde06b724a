"""What every controller is: the five moments of its life, and what it is given in each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeVarTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

    from rclpy.node import Node

    from tutorial.body import Body

Ts = TypeVarTuple("Ts")


class CallLater(Protocol):
    """What `ControllerConfig.call_later` is."""

    def __call__(self, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        """Run ``function(*args)`` on the main thread. Any thread."""


class CallLatest(Protocol):
    """What `ControllerConfig.call_latest` is."""

    def __call__(self, key: Hashable, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        """Run ``function(*args)`` on the main thread, in the place of a waiting call of the same key. Any thread."""


@dataclass(frozen=True)
class ControllerConfig:
    """What a controller is given when it joins a body.

    Attributes:
        body: the displayed body; it belongs to the main thread.
        node: the program's ROS 2 node; its callbacks run on the executor's thread.
        call_later: ``call_later(function, *args)``, from any thread: run the function on the main thread. Every call is
            kept, in order; those that still wait when the controller leaves its body do not run.
        call_latest: ``call_latest(key, function, *args)``, as `call_later`, but a call of the same key that still
            waits is replaced.
    """

    body: Body
    node: Node
    call_later: CallLater
    call_latest: CallLatest


class ControllerIO:
    """A controller's access to the simulated copy of its body; it belongs to the thread that steps the simulation.

    Attributes:
        body: the simulated body.
        time_step: [s].
        step: how many steps have been simulated since the program began; after a stop they go on.
    """

    __slots__ = ("_step_ns", "body", "step", "time_step")

    def __init__(self, body: Body, time_step: float) -> None:
        self.body = body
        self.time_step = time_step
        self.step = 0
        self._step_ns = round(time_step * 1e9)

    @property
    def time_ns(self) -> int:
        """Simulated time since the program began [ns], an exact multiple of the time step."""
        return self.step * self._step_ns

    @property
    def time(self) -> float:
        """Simulated time since the program began [s]."""
        return self.time_ns / 1e9


class SimpleController:
    """Base of all controllers, named and cut as in the original. Each method says on which thread it is called.

    A controller of a displayed body is configured and unconfigured; one in a simulated world is also initialized, asked
    for control at every step, and stopped.
    """

    def configure(self, config: ControllerConfig) -> None:
        """Join a body: make publishers and subscriptions. Main thread."""

    def initialize(self, io: ControllerIO) -> None:
        """Get ready for the first step, at every start of the simulation. The thread that steps it."""

    def control(self) -> None:
        """Read sensors and set actuators, before every step. The thread that steps the simulation."""

    def stop(self) -> None:
        """Let go, when no step will ask for control any more. A thread of the simulation's."""

    def unconfigure(self) -> None:
        """Leave the body: destroy what `configure` made. Main thread."""
