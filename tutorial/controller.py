"""The base class of all controllers, and the objects that its methods receive."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, TypeVar, TypeVarTuple

from tutorial.handoff import RequestQueue

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable

    from rclpy.node import Node

    from tutorial.body import Body

T = TypeVar("T")
Ts = TypeVarTuple("Ts")


class CallLater(Protocol):
    """The type of `ControllerConfig.call_later`."""

    def __call__(self, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        """Run ``function(*args)`` on the main thread. Thread-safe."""


class CallLatest(Protocol):
    """The type of `ControllerConfig.call_latest`."""

    def __call__(self, key: Hashable, function: Callable[[*Ts], object], /, *args: *Ts) -> None:
        """Run ``function(*args)`` on the main thread, in place of a waiting call with the same key. Thread-safe."""


class Ask(Protocol):
    """The type of `ControllerConfig.ask`."""

    def __call__(self, function: Callable[[*Ts], T], /, *args: *Ts, timeout: float = ...) -> T:
        """Run ``function(*args)`` on the simulation's thread, and return the result. Thread-safe."""


@dataclass(frozen=True)
class ControllerConfig:
    """The parts of the program that a controller receives when it joins a body.

    Attributes:
        body: the displayed body, for use on the main thread only.
        node: the program's ROS 2 node; its callbacks run on the executor's thread.
        call_later: ``call_later(function, *args)``, called on any thread, runs the function on the main thread. Calls
            run in the order they were posted. No call is lost, unless it is still waiting when the controller leaves
            its body.
        call_latest: ``call_latest(key, function, *args)`` works like `call_later`, but replaces a waiting call that has
            the same key.
        ask: ``ask(function, *args)``, called on the executor's thread, has the simulation's thread run the function
            between two steps, and returns the result. If the function cannot be run, or does not return in
            time, ``ask`` raises a RefusedError that gives the reason: see `tutorial.handoff.RequestQueue.ask`.
    """

    body: Body
    node: Node
    call_later: CallLater
    call_latest: CallLatest
    ask: Ask = field(default_factory=lambda: RequestQueue().ask)  # refuses every request


class ControllerIO:
    """A controller's access to the simulated copy of its body, for use only on the thread that steps the simulation.

    Attributes:
        body: the simulated body.
        time_step: the time step [s].
        step: the number of steps since the program began. Restarting the simulation does not reset this number.
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
    """Base class of controllers, with the original tutorial's names and methods.

    On a displayed body, only `configure` and `unconfigure` are called. A simulation also calls `initialize` when it
    starts, `control` before every step, and `stop` after the last step. Each method's docstring names the thread that
    calls it.
    """

    def configure(self, config: ControllerConfig) -> None:
        """Join a body: make publishers and subscriptions. Called on the main thread."""

    def initialize(self, io: ControllerIO) -> None:
        """Prepare for the first step, whenever the simulation starts. Called on the simulation's thread."""

    def control(self) -> None:
        """Read sensors and set actuators, before every step. Called on the simulation's thread."""

    def stop(self) -> None:
        """Finish: `control` is not called until the simulation restarts. Called on one of the simulation's threads."""

    def unconfigure(self) -> None:
        """Leave the body: destroy the publishers and subscriptions that `configure` made. Called on the main thread."""
