"""A ROS domain of one's own, so that runs side by side don't hear each other."""

from __future__ import annotations

import fcntl
import os
import random
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["FIRST", "LAST", "reserved_domain"]

FIRST, LAST = 1, 101  # those whose ports ROS 2 says are free on every system


@contextmanager
def reserved_domain(avoid: str | None = None) -> Iterator[int]:
    """Hold a ROS_DOMAIN_ID that nobody else holds; a lock file of each number, let go when the process ends.

    Args:
        avoid: a ROS_DOMAIN_ID that is in use without being held, if there is one.

    Raises:
        RuntimeError: all of them are taken.
    """
    directory = Path(tempfile.gettempdir()) / f"ros-domains-{os.getuid()}"
    directory.mkdir(exist_ok=True)
    for number in random.sample(range(FIRST, LAST + 1), LAST - FIRST + 1):
        if str(number) == (avoid or "").strip():
            continue
        with (directory / str(number)).open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield number
            return
    raise RuntimeError(f"all ROS domains from {FIRST} to {LAST} are taken: see {directory}")
