"""Reserve a ROS domain, so that programs that run at the same time don't receive each other's messages."""

import random
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from tutorial.errors import TutorialError

DOMAINS = [*range(11, 102), *(range(215, 233) if sys.platform == "linux" else ())]
"""Domain IDs whose ports the system does not assign to other programs (ROS 2's documentation, "The ROS_DOMAIN_ID").

IDs up to 10 are reserved for people, who choose them by hand, and for the doctor, which searches them.
"""


@contextmanager
def reserved_domain(avoid: str | None = None) -> Iterator[int]:
    """Reserve a ROS_DOMAIN_ID that no program of any user on this machine has reserved.

    DDS uses the domain's first port for UDP. This function binds the same TCP port without listening; the port is
    released when the process ends, at the latest. Containers with separate networks can reserve the same ID without
    conflict.

    Args:
        avoid: a ROS_DOMAIN_ID that is in use but not reserved, if any.

    Raises:
        TutorialError: all IDs are taken; the error says what to do.
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
