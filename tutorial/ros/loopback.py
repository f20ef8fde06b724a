"""Check the loopback interface, which connects the programs on one machine."""

import errno
import socket
import sys

from tutorial.errors import TutorialError

ADDRESS = ("127.0.0.1", 9)
DOWN = (errno.ENETUNREACH, errno.ENETDOWN, errno.EADDRNOTAVAIL)
TURN_ON = "sudo ifconfig lo0 up" if sys.platform == "darwin" else "sudo ip link set lo up"


def loopback_is_up() -> bool:
    """Return whether this machine can send packets to itself; some containers cannot."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(ADDRESS)  # over UDP, this sends nothing
        except OSError as error:
            return error.errno not in DOWN
    return True


def require_loopback() -> None:
    """Raise an error if the loopback interface is down: without it, Cyclone DDS fails, and Fast DDS finds no nodes.

    Raises:
        TutorialError: the interface is down.
    """
    if not loopback_is_up():
        raise TutorialError(
            "the loopback interface (127.0.0.1) is down, so programs on this machine cannot find each other. "
            f"Turn it on: {TURN_ON}"
        )
