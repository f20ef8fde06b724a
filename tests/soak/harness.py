"""What the soaks share: their command line and verdict, the processes that they start, and whether memory is flat."""

import os
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import psutil
from tables import console

from tutorial.ros.domains import reserved_domain
from tutorial.system import parent_watch

EVERY = 0.1  # [s] between two samples of memory
WARM_UP = 0.25  # of the run: allocators, DDS's buffers and the caches of an interpreter find their size
GROWTH = 4.0
"""How much memory may grow after the warm-up [MB]. In a run of 60 s, 45,000 messages are sent in that time, so 100
bytes that stay behind of each are found: a copy of a message of 40 joints is 1,700. What is no leak is below it: the
backlog of a second in which a busy machine did something else, of which malloc keeps the pages, and an arena that the
interpreter adds."""
MEMORY = "memory has grown by {:.1f} MB, at most {:g} are allowed"


def soak(seconds: int, job: Callable[[int], list[str]]) -> None:
    """Be the command ``[SECONDS]``: do a job in a ROS domain of its own, say what does not hold, and exit.

    Args:
        seconds: how long each kind takes, unless another time is given [s].
        job: takes the seconds, and returns what does not hold.
    """
    with reserved_domain() as domain:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        complaints = job(int(sys.argv[1]) if sys.argv[1:] else seconds)
    for complaint in complaints:
        console.print(f"does not hold: {complaint}", style="red", highlight=False)
    console.print("" if complaints else "all holds", end="" if complaints else "\n")
    sys.exit(bool(complaints))


def above(*limits: tuple[float, float, str]) -> list[str]:
    """Say which values are above their bounds: each has a text with a place for the value and one for the bound."""
    return [text.format(value, bound) for value, bound, text in limits if value > bound]


@contextmanager
def python(*command: object, **variables: str) -> Iterator[subprocess.Popen[str]]:
    """Run a Python program, in a group of its own, which spares it the terminal's Ctrl-C. In the end it is killed."""
    words = [sys.executable, *map(str, command)]
    with parent_watch.start_watched(words, {**os.environ, **variables}) as process:
        try:
            yield process
        finally:
            parent_watch.signal_group(process.pid, signal.SIGKILL)


class Memory:
    """Samples of this process's resident memory [MB]."""

    def __init__(self) -> None:
        self._process = psutil.Process()
        self._samples: list[float] = []
        self._due = 0.0

    def look(self) -> None:
        """Take a sample, if it is time for one."""
        if time.monotonic() >= self._due:
            self._due = time.monotonic() + EVERY
            self._samples.append(self._process.memory_info().rss / 1e6)

    def growth(self) -> float:
        """Return by how much it has grown after the warm-up, in the median: one sample may catch a moment's peak."""
        samples = self._samples[int(WARM_UP * len(self._samples)) :]
        tenth = len(samples) // 10 + 1
        return statistics.median(samples[-tenth:]) - statistics.median(samples[:tenth])
