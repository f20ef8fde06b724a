"""Who can discover a program, where it looks for others, and how many programs a domain can have."""

import errno
import socket
from contextlib import ExitStack
from unittest.mock import Mock

import pytest
from cyclonedds.core import DDSException

_domain = pytest.importorskip("rclpy._domain", reason="a real ROS 2 is in use, and this test is for the pocket one")
_cyclone = pytest.importorskip("rclpy._cyclone")

REACH, PEERS = "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS"


@pytest.fixture(autouse=True)
def _no_network(monkeypatch):
    """Resolve host names without the network."""

    def resolve(host):
        if host not in ("localhost", "127.0.0.1"):
            raise socket.gaierror("Name or service not known")
        return "127.0.0.1"

    monkeypatch.setattr(socket, "gethostbyname", resolve)


@pytest.mark.parametrize(
    ("variables", "said"),
    [
        ({}, '<AllowMulticast>false</AllowMulticast><Interfaces><NetworkInterface address="127.0.0.1"/>'),
        (
            {REACH: "SUBNET"},
            '<AllowMulticast>true</AllowMulticast><Interfaces><NetworkInterface autodetermine="true"/>',
        ),
        ({REACH: "SYSTEM_DEFAULT"}, "<CycloneDDS/>"),
        ({REACH: "SYSTEM_DEFAULT", "CYCLONEDDS_URI": "file:///mine.xml"}, "file:///mine.xml"),
        (
            {PEERS: " localhost;localhost:7411; ;"},
            '<Peer address="127.0.0.1" PruneDelay="inf"/><Peer address="127.0.0.1:7411" PruneDelay',
        ),
    ],
)
def test_discovery_range_and_peers(variables, said, monkeypatch):
    for name in (REACH, PEERS, "CYCLONEDDS_URI"):
        monkeypatch.setenv(name, variables.get(name, ""))
    assert said in _domain.configuration()


def test_peers_do_not_matter_if_the_range_is_off(monkeypatch):
    monkeypatch.setenv(PEERS, "no-such-machine")
    monkeypatch.setenv(REACH, "OFF")
    assert "Peer" not in _domain.configuration()


@pytest.mark.parametrize("peer", ["no-such-machine", "<b>", "localhost:x", "localhost:70000", "::1", "\x1b[2J"])
def test_an_unknown_peer_is_named(peer, domain, monkeypatch):
    monkeypatch.setenv(PEERS, f"127.0.0.1;{peer}")
    with pytest.raises(RuntimeError) as raised:
        _cyclone.join(domain)
    said = f"failed to initialize rcl: ROS_STATIC_PEERS contains {peer!r}, which cannot be found"
    assert str(raised.value).startswith(said)
    assert "separated by semicolons" in str(raised.value)


def test_loopback_down(domain, monkeypatch):
    def connect(self, address):
        raise OSError(errno.ENETUNREACH, "Network is unreachable")

    monkeypatch.setattr(_cyclone, "Domain", Mock(side_effect=DDSException(-1)))
    monkeypatch.setattr(socket.socket, "connect", connect)
    with pytest.raises(RuntimeError, match=rf"interface .* is down\. Turn it on: {_domain.TURN_ON_LOOPBACK}"):
        _cyclone.join(domain)


def test_too_many_processes_are_reported(domain, monkeypatch):
    monkeypatch.setattr(_domain, "MAX_PARTICIPANTS", 1)
    with ExitStack() as stack:
        for port in range(7410, 7414):  # the ports of two processes
            taken = stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            taken.bind(("", port + 250 * domain))
        with pytest.raises(RuntimeError, match=r"too many ROS 2 programs .* machine \(the limit is 1\)"):
            _cyclone.join(domain)
