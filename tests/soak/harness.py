"""Shared parts of the soaks: command line, verdict, processes, and whether memory stays flat."""

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
WARM_UP = 0.25  # share of the run in which allocators, DDS's buffers and the interpreter's caches grow
GROWTH = 4.0
"""The memory that a process may gain after the warm-up [MB]. A run of 60 s sends 45,000 messages in that time, so this
finds a leak of 100 bytes per message; a copy of a message with 40 joints takes 1,700 bytes. The limit allows for growth
that is not a leak: the pages that malloc keeps after a busy machine has caused a backlog of a second, and an arena that
the interpreter adds."""
MEMORY = "memory has grown by {:.1f} MB, at most {:g} are allowed"


def soak(seconds: int, job: Callable[[int], list[str]]) -> None:
    """Run the command ``[SECONDS]``: do a job in a separate ROS domain, print the unmet requirements, and exit.

    Args:
        seconds: the default duration of each kind [s].
        job: takes the seconds, and returns the requirements that are not met.
    """
    with reserved_domain() as domain:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        complaints = job(int(sys.argv[1]) if sys.argv[1:] else seconds)
    for complaint in complaints:
        console.print(f"failed: {complaint}", style="red", highlight=False)
    console.print("" if complaints else "all requirements are met", end="" if complaints else "\n")
    sys.exit(bool(complaints))


def above(*limits: tuple[float, float, str]) -> list[str]:
    """Return a text for each value above its bound, from a format with places for both."""
    return [text.format(value, bound) for value, bound, text in limits if value > bound]


@contextmanager
def python(*command: object, **variables: str) -> Iterator[subprocess.Popen[str]]:
    """Run a Python program in its own group, which shields it from the terminal's Ctrl-C, and kill it at the end."""
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
        """Take a sample if one is due."""
        if time.monotonic() >= self._due:
            self._due = time.monotonic() + EVERY
            self._samples.append(self._process.memory_info().rss / 1e6)

    def growth(self) -> float:
        """Return the median growth after the warm-up: a single sample may catch a peak."""
        samples = self._samples[int(WARM_UP * len(self._samples)) :]
        tenth = len(samples) // 10 + 1
        return statistics.median(samples[-tenth:]) - statistics.median(samples[:tenth])
