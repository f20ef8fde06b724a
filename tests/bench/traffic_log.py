"""What both sides of a measurement share: when to publish, and what is noted of what arrives."""

import statistics
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any, NoReturn

MESSAGES = 300
WARM_UP = 50
PERIOD = 0.01  # [s]
FLOOD = 2.0  # [s] for which those that arrive are counted
PACE = sys.argv[1] if len(sys.argv) > 1 else "beat"  # flood and cost: as fast as can be
FLOODS = PACE != "beat"


def stamps() -> Iterator[int]:
    """Wait out each period, and give the time at which to publish [ns]; for ever, for the first may find nobody."""
    while True:
        time.sleep(PERIOD)
        yield time.time_ns()


def flood(publish: Callable[[Any], object], message: Any) -> NoReturn:
    """Publish the same message for ever. It is serialised already: so whoever receives it is the slower one."""
    while True:
        publish(message)


class Log:
    """What a subscriber notes of each message: how old it is [ns]."""

    def __init__(self) -> None:
        self._ages: list[int] = []
        self._began = self._began_cpu = 0.0

    def add(self, stamp: Any) -> None:
        """Note a message, by the stamp in it."""
        if not self._began:
            self._began, self._began_cpu = time.monotonic(), time.thread_time()
        self._ages.append(time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec)

    @property
    def full(self) -> bool:
        """Whether that is enough."""
        return bool(self._began) and (time.monotonic() > self._began + FLOOD if FLOODS else len(self._ages) >= MESSAGES)

    def finish(self) -> None:
        """Hand the median, or what one takes, on the clock or of this thread's processor, over to the parent [s]."""
        if FLOODS:
            cost = time.thread_time() - self._began_cpu
            print((cost if PACE == "cost" else time.monotonic() - self._began) / len(self._ages))
        else:
            print(statistics.median(self._ages[WARM_UP:]) / 1e9)
