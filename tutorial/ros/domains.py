"""A ROS domain of one's own, so that runs side by side don't hear each other."""

from __future__ import annotations

import fcntl
import os
import random
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

__all__ = ["FIRST", "LAST", "reserved_domain", "shared_folder"]

FIRST, LAST = 1, 101  # those whose ports ROS 2 says are free on every system


@contextmanager
def reserved_domain(avoid: str | None = None) -> Iterator[int]:
    """Hold a ROS_DOMAIN_ID that nobody else holds: a lock on its file, released at the latest when the process ends.

    Args:
        avoid: a ROS_DOMAIN_ID that is in use without being held, if there is one.

    Raises:
        RuntimeError: all of them are taken.
    """
    directory = shared_folder()
    for number in random.sample(range(FIRST, LAST + 1), LAST - FIRST + 1):
        if str(number) == (avoid or "").strip():
            continue
        lock = _open(directory / str(number))
        try:
            if _locked(lock):
                yield number
                return
        finally:
            os.close(lock)
    raise RuntimeError(f"all ROS domains from {FIRST} to {LAST} are taken: see {directory}")


def shared_folder() -> Path:
    """Return the folder of the locks. All users of this machine have it in common: their programs hear each other."""
    directory = Path(tempfile.gettempdir()) / "ros-domains"
    with suppress(FileExistsError):
        directory.mkdir()
        directory.chmod(0o1777)
    return directory


def _open(path: Path) -> int:
    """Open a lock file, whoever made it; to lock it, it is enough to be allowed to read it."""
    with suppress(FileExistsError, PermissionError):
        made = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL)
        os.fchmod(made, 0o644)
        os.close(made)
    return os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_NOFOLLOW)  # nothing that somebody else has put there


def _locked(file: int) -> bool:
    """Lock a file, unless another process or another opening of it has it locked."""
    with suppress(BlockingIOError):
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return True
    return False
