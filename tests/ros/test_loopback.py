"""A machine that cannot send packets to itself."""

import errno
import socket

import pytest

from tutorial.errors import TutorialError
from tutorial.ros.loopback import loopback_is_up
from tutorial.ros.node_thread import NodeThread


@pytest.mark.parametrize(("number", "is_up"), [(errno.ENETUNREACH, False), (errno.EPERM, True), (None, True)])
def test_loopback_is_up(monkeypatch, number, is_up):
    def connect(_, address):
        assert address[0] == "127.0.0.1"
        if number:
            raise OSError(number, "no")

    monkeypatch.setattr(socket.socket, "connect", connect)
    assert loopback_is_up() == is_up


def test_no_node_without_loopback(domain, monkeypatch):
    monkeypatch.setattr("tutorial.ros.loopback.loopback_is_up", lambda: False)
    with pytest.raises(TutorialError, match=r"the loopback interface \(127\.0\.0\.1\) is down, so programs"):
        NodeThread("nobody")
