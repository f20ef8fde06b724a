"""A ROS domain of one's own, so that runs side by side don't hear each other."""

from __future__ import annotations

import fcntl
import os
import random
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

FIRST, LAST = 1, 101


@contextmanager
def reserved_domain() -> Iterator[int]:
    """Hold a ROS_DOMAIN_ID that nobody else holds; a lock file of each number, let go when the process ends."""
    directory = Path(tempfile.gettempdir()) / f"ros-domains-{os.getuid()}"
    directory.mkdir(exist_ok=True)
    for number in random.sample(range(FIRST, LAST + 1), LAST - FIRST + 1):
        with (directory / str(number)).open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield number
            return
    raise RuntimeError(f"all ROS domains from {FIRST} to {LAST} are taken: see {directory}")
