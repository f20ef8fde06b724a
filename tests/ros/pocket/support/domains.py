"""Reserve a ROS domain, so that test runs at the same time don't hear each other."""

import random
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def reserved_domain() -> Iterator[int]:
    """Hold a free ROS_DOMAIN_ID from 11 to 101 by binding its first port for TCP, which DDS does not use.

    A domain is not free if a program has the first participant's UDP port.
    """
    for number in random.sample(range(11, 102), 91):
        port = 7400 + 250 * number
        with suppress(OSError), socket.socket() as held, socket.socket(type=socket.SOCK_DGRAM) as participant:
            held.bind(("127.0.0.1", port))
            participant.bind(("127.0.0.1", port + 10))
            participant.close()
            yield number
            return
    raise RuntimeError("all ROS domains are taken")
