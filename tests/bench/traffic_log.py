"""What both sides of a measurement share: when to publish, and what is noted of what arrives."""

import statistics
import sys
import time
from collections.abc import Iterator
from typing import Any

MESSAGES = 300
WARM_UP = 50
PERIOD = 0.01  # [s]
FLOOD = 2.0  # [s] for which those that arrive are counted
FLOODS = sys.argv[1:2] == ["flood"]  # or else they come at a steady beat


def stamps() -> Iterator[int]:
    """Wait out each period, if there is one, and give the time at which to publish [ns]."""
    while FLOODS:
        yield time.time_ns()
    for _ in range(MESSAGES):
        time.sleep(PERIOD)
        yield time.time_ns()


class Log:
    """What a subscriber notes of each message: how old it is [ns]."""

    def __init__(self) -> None:
        self._ages: list[int] = []
        self._began = 0.0

    def add(self, stamp: Any) -> None:
        """Note a message, by the stamp in it."""
        self._began = self._began or time.monotonic()
        self._ages.append(time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec)

    @property
    def full(self) -> bool:
        """Whether that is enough."""
        return bool(self._began) and (time.monotonic() > self._began + FLOOD if FLOODS else len(self._ages) >= MESSAGES)

    def finish(self) -> None:
        """Hand the median, or the time between two, over to the parent [s]."""
        if FLOODS:
            print((time.monotonic() - self._began) / len(self._ages))
        else:
            print(statistics.median(self._ages[WARM_UP:]) / 1e9)
