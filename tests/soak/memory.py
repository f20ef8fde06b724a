"""Whether a process's memory is flat while messages go through it."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from typing import NamedTuple

import psutil

EVERY = 0.1  # [s] between two samples
WARM_UP = 0.25  # of the run: allocators, DDS's buffers and the caches of an interpreter find their size
BOUND = 4.0
"""How much memory may grow after the warm-up [MB]. In a run of 60 s, 45,000 messages are sent in that time, so 100
bytes that stay behind of each are found: a copy of a message of 40 joints is 1,700. What is no leak is below it: the
backlog of a second in which a busy machine did something else, of which malloc keeps the pages, and an arena that the
interpreter adds."""

MB = 1e6


class Trend(NamedTuple):
    """Resident memory after the warm-up [MB], each a median: a single sample may catch a moment's peak."""

    start: float
    end: float
    thirds: Sequence[float]

    @property
    def growth(self) -> float:
        return self.end - self.start

    @property
    def flat(self) -> bool:
        return self.growth <= BOUND


class Memory:
    """Samples of this process's resident memory."""

    def __init__(self) -> None:
        self._process = psutil.Process()
        self._samples: list[int] = []
        self._due = 0.0

    def look(self) -> None:
        """Take a sample, if it is time for one."""
        if time.monotonic() >= self._due:
            self._due = time.monotonic() + EVERY
            self._samples.append(self._process.memory_info().rss)

    def trend(self, warm_up: float = WARM_UP) -> Trend:
        """Sum them up, without a share of them at the beginning."""
        samples = [sample / MB for sample in self._samples[int(warm_up * len(self._samples)) :]]
        tenth = len(samples) // 10 + 1
        return Trend(statistics.median(samples[:tenth]), statistics.median(samples[-tenth:]), thirds(samples))


def thirds(samples: Sequence[float]) -> tuple[float, ...]:
    """Return the medians of the first, the second and the last third; one of fewer than three is all of them."""
    size = max(len(samples) // 3, 1)
    return tuple(statistics.median(part) for part in (samples[:size], samples[size:-size] or samples, samples[-size:]))
