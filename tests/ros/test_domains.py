"""Reserving a free ROS domain."""

import socket

import pytest

from tutorial.errors import TutorialError
from tutorial.ros import domains
from tutorial.ros.domains import FIRST_PORT, FIRST_UNICAST, PORTS, reserved_domain


def test_a_domain_is_exclusive_until_it_is_released(monkeypatch):
    with reserved_domain() as mine:
        monkeypatch.setattr(domains, "DOMAINS", [mine])
        with pytest.raises(TutorialError, match="all 1 ROS domains on this machine are taken: shut down kernels"):
            reserved_domain().__enter__()
    with reserved_domain() as again:
        assert again == mine
    with pytest.raises(TutorialError):
        reserved_domain(avoid=f"{mine} ").__enter__()


@pytest.mark.parametrize("kind", [socket.SOCK_DGRAM, socket.SOCK_STREAM])
def test_a_domain_with_a_participant_is_not_free(monkeypatch, kind):
    with reserved_domain() as first, reserved_domain() as second:
        pass
    monkeypatch.setattr(domains, "DOMAINS", [first, second])
    offset = FIRST_UNICAST if kind == socket.SOCK_DGRAM else 0
    with socket.socket(type=kind) as participant:
        participant.bind(("0.0.0.0", FIRST_PORT + PORTS * first + offset))
        with reserved_domain() as found:
            assert found == second


def test_a_closed_connection_does_not_block_a_domain(monkeypatch):
    with reserved_domain() as mine:
        pass
    monkeypatch.setattr(domains, "DOMAINS", [mine])
    with socket.socket() as server, socket.socket() as client:
        server.bind(("127.0.0.1", 0))
        server.listen()
        client.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        client.bind(("127.0.0.1", FIRST_PORT + PORTS * mine))
        client.connect(server.getsockname())
        accepted, _ = server.accept()
        client.close()  # first, so that the port stays in TIME_WAIT
        accepted.close()
    with reserved_domain() as again:
        assert again == mine
