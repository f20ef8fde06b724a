"""Reserve a ROS domain, so that programs that run at the same time don't receive each other's messages."""

import random
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from tutorial.errors import TutorialError

FIRST_PORT, PORTS = 7400, 250
"""The first UDP port of domain 0, and the number of ports per domain."""
FIRST_UNICAST = 10  # offset of the first participant's first port; each participant has two ports
DOMAINS = [*range(11, 102), *(range(215, 233) if sys.platform == "linux" else ())]
"""Domain IDs whose ports the system does not assign to other programs.

See "The ROS_DOMAIN_ID" in the ROS 2 documentation. The list omits the IDs up to 10: people choose them by hand, and the
doctor searches those domains.
"""


@contextmanager
def reserved_domain(avoid: str | None = None) -> Iterator[int]:
    """Reserve a ROS_DOMAIN_ID that no program on this machine has reserved or is using, whichever user runs it.

    DDS uses the domain's first port for UDP. This function listens on the TCP port with the same number, which is
    released when the process ends, at the latest. It skips domains where a program already uses the first
    participant's UDP port. Containers with separate networks can reserve the same ID without conflict.

    Args:
        avoid: an additional ROS_DOMAIN_ID to skip, if any.

    Raises:
        TutorialError: no ID is free; the error says what to do.
    """
    for number in random.sample(DOMAINS, len(DOMAINS)):
        if str(number) == (avoid or "").strip():
            continue
        port = FIRST_PORT + PORTS * number
        with socket.socket() as held, socket.socket(type=socket.SOCK_DGRAM) as participant:
            held.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # otherwise, closed connections block the port
            try:
                held.bind(("127.0.0.1", port))
                held.listen()
                participant.bind(("127.0.0.1", port + FIRST_UNICAST))
            except OSError:
                continue
            participant.close()
            yield number
            return
    taken = f"all {len(DOMAINS)} ROS domains on this machine are taken"
    raise TutorialError(f"{taken}: shut down kernels that you no longer use, or set ROS_DOMAIN_ID")
