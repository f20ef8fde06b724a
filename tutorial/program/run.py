"""When a program's run is over: with its simulation, or, for a program that only displays, with its time."""

import logging
import time
from dataclasses import dataclass, field

from tutorial.handoff import CallQueue
from tutorial.ros.node_thread import MeteredNode
from tutorial.simulation import Simulation

FRAME = 1 / 30  # [s] between two frames of the view, and two checks whether a run is over
HUNG = 5.0  # [s] without a step, before a run that has a duration is given up
QUIET = 0.3  # [s] of silence after which no more messages are expected

_log = logging.getLogger(__name__)


@dataclass
class SimulatedRun:
    """A run of a simulation, which has been started. It is over when the simulation stops.

    Args:
        simulation: what runs.
        has_duration: whether it should stop by itself. If it does not step any more, the run stops it.
    """

    simulation: Simulation
    has_duration: bool
    _step: int = 0  # when `is_over` was called last
    _still: int = 0  # for how many frames there was no step; seconds would count, too, while the whole process sleeps

    def is_over(self) -> bool:
        """Return whether the simulation has stopped. Call it once every frame."""
        self._still = self._still + 1 if self.simulation.step == self._step else 0
        self._step = self.simulation.step
        if self.has_duration and self._still > HUNG / FRAME:
            _log.warning("the simulation has made no step for %g s, so it is stopped", HUNG)
            self.simulation.stop()
        return not self.simulation.running


@dataclass
class DisplayedRun:
    """A run of a program that only displays. It is over after a time.

    Args:
        node: the program's node.
        calls: the main thread's queue of posted calls.
        duration: [s]; None to go on.
        linger: the longest wait after the duration [s], for the publishers to go and their messages to be shown.

    Attributes:
        seconds: how long it has gone on [s].
    """

    node: MeteredNode
    calls: CallQueue
    duration: float | None
    linger: float
    seconds: float = 0.0
    _began: float = field(default_factory=time.monotonic)

    def is_over(self) -> bool:
        """Return whether the time is over. Call it once every frame."""
        self.seconds = time.monotonic() - self._began
        if self.duration is None or self.seconds < self.duration:
            return False
        return self.seconds >= self.duration + self.linger or self._is_drained()

    def _is_drained(self) -> bool:
        """Return whether the publishers have come and gone, and all their messages are shown."""
        received = [meter for meter in self.node.meters if meter.direction == "received"]
        return (
            not any(self.node.count_publishers(meter.topic) for meter in received)
            and all(meter.count and meter.idle > QUIET for meter in received)
            and not len(self.calls)
        )
