"""What all tests share. `tutorial` comes first: it is what makes rclpy importable."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest
from domains import reserved_domain
from programs import Program

import tutorial  # noqa: F401


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain that nobody else uses; processes started by the test inherit it."""
    with reserved_domain() as number:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
        yield number


@pytest.fixture
def program(domain: int) -> Iterator[Callable[..., Program]]:
    """Start ``tank`` with some arguments, in a domain of its own; what is left of it in the end is killed."""
    started: list[Program] = []

    def start(*arguments: object, environment: dict[str, str] | None = None) -> Program:
        started.append(Program(*arguments, environment=environment))
        return started[-1]

    yield start
    for running in started:
        running.clear()
