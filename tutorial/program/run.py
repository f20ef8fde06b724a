"""Decide when a program's run is over: when its simulation stops or, if it has none, after a given duration."""

import logging
import time
from dataclasses import dataclass, field

from tutorial.handoff import CallQueue
from tutorial.ros.node_thread import MeteredNode
from tutorial.simulation import Simulation

FRAME = 1 / 30  # [s] between frames of the view, and between checks of whether a run is over
HUNG = 5.0  # [s] how long a timed run can go without a step before it is stopped
QUIET = 0.3  # [s] how long a silence has to last before no more messages are expected

_log = logging.getLogger(__name__)


@dataclass
class SimulatedRun:
    """A run of a program whose simulation has been started. It is over when the simulation stops.

    Args:
        simulation: the running simulation.
        has_duration: whether the simulation is supposed to stop after a given duration. If it hangs before that,
            `is_over` stops it.
    """

    simulation: Simulation
    has_duration: bool
    _step: int = 0  # the step at the last call to `is_over`
    _still: int = 0  # frames without a step (not seconds: they also pass while the whole process is suspended)

    def is_over(self) -> bool:
        """Return whether the simulation has stopped. Call this method once per frame."""
        self._still = self._still + 1 if self.simulation.step == self._step else 0
        self._step = self.simulation.step
        if self.has_duration and self._still > HUNG / FRAME:
            _log.warning("the simulation has not advanced for %g s, so it is being stopped", HUNG)
            self.simulation.stop()
        return not self.simulation.running


@dataclass
class DisplayedRun:
    """A run of a program without a simulation. It is over after a given duration.

    Args:
        node: the program's node.
        calls: the main thread's queue of posted calls.
        duration: the run's duration [s]; None for no limit.
        linger: the maximum time to wait, after the duration, for the publishers to leave and for their messages to be
            shown [s].

    Attributes:
        seconds: how long the run has lasted so far [s].
    """

    node: MeteredNode
    calls: CallQueue
    duration: float | None
    linger: float
    seconds: float = 0.0
    _began: float = field(default_factory=time.monotonic)

    def is_over(self) -> bool:
        """Return whether the run is over. Call this method once per frame."""
        self.seconds = time.monotonic() - self._began
        if self.duration is None or self.seconds < self.duration:
            return False
        return self.seconds >= self.duration + self.linger or self._is_drained()

    def _is_drained(self) -> bool:
        """Return whether all publishers have joined and left, and all their messages have been shown."""
        received = [meter for meter in self.node.meters if meter.direction == "received"]
        return (
            not any(self.node.count_publishers(meter.topic) for meter in received)
            and all(meter.count and meter.idle > QUIET for meter in received)
            and not len(self.calls)
        )
