"""Reserving a free ROS domain."""

import pytest

from tutorial.errors import TutorialError
from tutorial.ros import domains
from tutorial.ros.domains import reserved_domain


def test_a_domain_is_exclusive_until_it_is_released(monkeypatch):
    with reserved_domain() as mine:
        monkeypatch.setattr(domains, "DOMAINS", [mine])
        with pytest.raises(TutorialError, match="all 1 ROS domains of this machine are taken: shut down kernels"):
            reserved_domain().__enter__()
    with reserved_domain() as again:
        assert again == mine
    with pytest.raises(TutorialError):
        reserved_domain(avoid=f"{mine} ").__enter__()
