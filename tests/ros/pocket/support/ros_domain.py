"""A pytest plugin: report which ROS 2 is in use, and give each test its own domain."""

from collections.abc import Iterator
from typing import Any

import pytest
from domains import reserved_domain
from hypothesis import HealthCheck, settings

import pocket_ros2

settings.register_profile("random", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("the same every time", settings.get_profile("random"), derandomize=True)
settings.load_profile("the same every time")

MARKS = (
    "pocket: tests only the pocket ROS 2; skipped with a reason where a real one is in use",
    "process: starts more processes, because one is not enough for what it tests",
)


def pytest_configure(config: pytest.Config) -> None:
    """Register the marks of these tests."""
    for mark in MARKS:
        config.addinivalue_line("markers", mark)


@pytest.fixture(scope="session")
def backend() -> str:
    """The ROS 2 that the tests run on: ``rclpy``, a real one, or ``pocket``."""
    return "pocket" if pocket_ros2.install() else "rclpy"


@pytest.fixture(autouse=True)
def _pocket_only(request: pytest.FixtureRequest, backend: str) -> None:
    """Skip tests that only concern the pocket ROS 2."""
    if backend != "pocket" and request.node.get_closest_marker("pocket"):
        pytest.skip("a real ROS 2 is in use, and this test is for the pocket one")


def pytest_report_header() -> str:
    """Show the backend at the top of a test run."""
    return f"ROS 2: {'pocket' if pocket_ros2.install() else 'rclpy'}"


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain that nothing else uses; processes started by the test inherit it."""
    with reserved_domain() as number:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
        yield number


@pytest.fixture
def stranger(domain: int) -> Iterator[Any]:
    """A `Stranger` in the test's domain, for tests of the pocket ROS 2."""
    from rclpy._cyclone import join
    from stranger import Stranger

    participant = join(domain)
    yield Stranger(participant)
    participant.leave()
