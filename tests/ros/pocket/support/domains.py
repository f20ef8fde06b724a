"""Reserve a ROS domain, so that test runs at the same time don't hear each other."""

import random
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress


@contextmanager
def reserved_domain() -> Iterator[int]:
    """Hold a free ROS_DOMAIN_ID from 11 to 101 by binding its first port for TCP, which DDS does not use."""
    with socket.socket() as held:
        for number in random.sample(range(11, 102), 91):
            with suppress(OSError):
                held.bind(("127.0.0.1", 7400 + 250 * number))
                break
        else:
            raise RuntimeError("all ROS domains are taken")
        yield number
