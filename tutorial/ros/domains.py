"""A ROS domain of one's own, so that runs side by side don't hear each other."""

from __future__ import annotations

import random
import socket
from collections.abc import Iterator
from contextlib import contextmanager

from tutorial.errors import TutorialError

FIRST, LAST = 1, 101  # those whose ports ROS 2 says are free on every system


@contextmanager
def reserved_domain(avoid: str | None = None) -> Iterator[int]:
    """Hold a ROS_DOMAIN_ID that nobody else on this machine holds, whichever user it is.

    DDS has the domain's first port for UDP. The one for TCP is held here; nobody listens on it. It is free again at the
    latest when the process ends.

    Args:
        avoid: a ROS_DOMAIN_ID that is in use without being held, if there is one.

    Raises:
        TutorialError: all of them are taken; the text says the mend.
    """
    for number in random.sample(range(FIRST, LAST + 1), LAST - FIRST + 1):
        if str(number) == (avoid or "").strip():
            continue
        with socket.socket() as held:
            try:
                held.bind(("127.0.0.1", 7400 + 250 * number))
            except OSError:
                continue
            yield number
            return
    raise TutorialError(f"all ROS domains from {FIRST} to {LAST} are taken: shut down kernels that you no longer use")
