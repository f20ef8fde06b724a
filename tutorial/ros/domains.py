"""A ROS domain of one's own, so that runs side by side don't hear each other."""

import random
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from tutorial.errors import TutorialError

DOMAINS = [*range(1, 102), *(range(215, 233) if sys.platform == "linux" else ())]
"""Those whose ports the system gives to no other program (ROS 2's documentation, "The ROS_DOMAIN_ID")."""


@contextmanager
def reserved_domain(avoid: str | None = None) -> Iterator[int]:
    """Hold a ROS_DOMAIN_ID that nobody else on this machine holds, whichever user it is.

    DDS has the domain's first port for UDP. The one for TCP is held here; nobody listens on it. It is free again at the
    latest when the process ends. Two containers with a network each may hold the same: they don't hear each other.

    Args:
        avoid: a ROS_DOMAIN_ID that is in use without being held, if there is one.

    Raises:
        TutorialError: all of them are taken; the text says the mend.
    """
    for number in random.sample(DOMAINS, len(DOMAINS)):
        if str(number) == (avoid or "").strip():
            continue
        with socket.socket() as held:
            try:
                held.bind(("127.0.0.1", 7400 + 250 * number))
            except OSError:
                continue
            yield number
            return
    taken = f"all {len(DOMAINS)} ROS domains of this machine are taken"
    raise TutorialError(f"{taken}: shut down kernels that you no longer use, or set ROS_DOMAIN_ID")
