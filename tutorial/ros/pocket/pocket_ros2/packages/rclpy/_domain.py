"""The DDS domain to join, and limits on who can discover this process.

By default, nobody outside this machine can discover the process, so that students in the same room don't drive each
other's tanks.
"""

import errno
import os
import socket
import sys
import threading
from xml.sax.saxutils import quoteattr

from rclpy._rclpy_pybind11 import RCLError

REACHES = ("OFF", "LOCALHOST", "SUBNET", "SYSTEM_DEFAULT")
MAX_PARTICIPANTS = 32
MAX_DOMAIN_ID = 232

LOOPBACK = ("127.0.0.1", 9)
TURN_ON_LOOPBACK = "sudo ifconfig lo0 up" if sys.platform == "darwin" else "sudo ip link set lo up"
UNREACHABLE = (errno.ENETUNREACH, errno.ENETDOWN, errno.EADDRNOTAVAIL)

lock = threading.RLock()
"""Hold this lock while you create, list or delete an entity of the middleware: Cyclone DDS's Python package fails if
one thread deletes an entity while another thread uses the entity to create something. A fork waits for this lock, so
that the child inherits no half-created entity."""


def default_domain_id() -> int:
    """Return the domain ID in ``ROS_DOMAIN_ID``, or 0 if the variable is not set.

    Raises:
        RCLError: ``ROS_DOMAIN_ID`` is not a number from 0 to 232.
    """
    text = os.environ.get("ROS_DOMAIN_ID", "").strip() or "0"
    if not (text.isdecimal() and int(text) <= MAX_DOMAIN_ID):
        raise RCLError(
            f"failed to initialize rcl: ROS_DOMAIN_ID is {text!r}, but must be a number up to {MAX_DOMAIN_ID}"
        )
    return int(text)


def configuration() -> str:
    """Return the Cyclone DDS configuration for the discovery range that is set in the environment.

    ``ROS_AUTOMATIC_DISCOVERY_RANGE`` is OFF, LOCALHOST (the default here), SUBNET or SYSTEM_DEFAULT, which leaves
    everything to Cyclone DDS; ``ROS_STATIC_PEERS`` is a list of addresses separated by ``;``. The configuration in
    ``CYCLONEDDS_URI`` is added to this one, as in a real ROS 2 that uses Cyclone DDS.

    Raises:
        RCLError: the range is not one of these values, or a peer cannot be found.
    """
    reach = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "") or "LOCALHOST"
    peers = [peer for peer in os.environ.get("ROS_STATIC_PEERS", "").split(";") if peer.strip()]
    if reach not in REACHES:
        raise RCLError(
            f"failed to initialize rcl: ROS_AUTOMATIC_DISCOVERY_RANGE is {reach!r}, but must be one of "
            f"{', '.join(REACHES)}"
        )
    if reach == "SYSTEM_DEFAULT":
        return os.environ.get("CYCLONEDDS_URI") or "<CycloneDDS/>"
    outside = reach == "SUBNET" or (reach == "LOCALHOST" and peers)
    interface = 'autodetermine="true"' if outside else 'address="127.0.0.1"'
    multicast = f"<AllowMulticast>{str(reach == 'SUBNET').lower()}</AllowMulticast>"
    general = f"<General>{multicast}<Interfaces><NetworkInterface {interface}/></Interfaces></General>"
    own = f'<Domain Id="any">{general}<Discovery>{_discovery(reach, peers)}</Discovery></Domain>'
    return ",".join(filter(None, (f"<CycloneDDS>{own}</CycloneDDS>", os.environ.get("CYCLONEDDS_URI"))))


def _address(peer: str) -> str:
    """Return a peer's IP address. Cyclone DDS would terminate the process if its own lookup failed."""
    host, colon, port = peer.strip().partition(":")
    try:
        if colon and not 0 < int(port) < 65_536:
            raise ValueError("there is no such port")
        return socket.gethostbyname(host) + colon + port
    except (OSError, ValueError) as error:
        text = f"failed to initialize rcl: ROS_STATIC_PEERS contains {peer!r}, which cannot be found ({error})."
        raise RCLError(f"{text} Use addresses such as 192.168.1.20, separated by semicolons.") from None


def _discovery(reach: str, peers: list[str]) -> str:
    """Return the part of the configuration that controls discovery."""
    if reach == "OFF":
        return f"<ParticipantIndex>none</ParticipantIndex><Tag>ros_discovery_off_{os.getpid()}</Tag>"
    everyone = ("127.0.0.1", *map(_address, peers))
    listed = "".join(f'<Peer address={quoteattr(peer)} PruneDelay="inf"/>' for peer in everyone)
    limit = f"<MaxAutoParticipantIndex>{MAX_PARTICIPANTS}</MaxAutoParticipantIndex>"
    return f"<ParticipantIndex>auto</ParticipantIndex>{limit}<SPDPInterval>1s</SPDPInterval><Peers>{listed}</Peers>"


def likely_cause(error: Exception) -> str:
    """Return the most likely cause of a failure to join the domain: Cyclone DDS itself returns only a number."""
    if not _loopback_is_up():
        return f"the loopback interface (127.0.0.1) is down. Turn it on: {TURN_ON_LOOPBACK}"
    return (
        f"{error} Usually, the cause is that too many ROS 2 programs are running on this machine (the limit is "
        f"{MAX_PARTICIPANTS}). Stop some of them, or set ROS_DOMAIN_ID to a different number."
    )


def _loopback_is_up() -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(LOOPBACK)  # over UDP, this sends nothing
        except OSError as error:
            return error.errno not in UNREACHABLE
    return True


os.register_at_fork(before=lock.acquire, after_in_parent=lock.release, after_in_child=lock.release)
