"""Shared fixtures and checks. Import `tutorial` first, because it makes rclpy importable."""

import signal
import sys
from collections.abc import Callable, Iterator

import pytest
from programs import Program

import tutorial  # noqa: F401

LANES = ("process", "browser", "build", "screen", "ros2", "nightly")
"""The marks of tests that may start processes. pyproject.toml explains each mark, and the Makefile shows which command
runs it."""

STARTS = {"os.fork", "os.forkpty", "os.posix_spawn", "os.system", "subprocess.Popen"}
"""Python's audit events for the start of a process."""

_alone: pytest.Item | None = None  # the running test, if it must not start processes


def _keep_to_the_lane(event: str, arguments: tuple[object, ...]) -> None:
    """Fail a test that starts a process without the mark for it."""
    if event in STARTS and _alone is not None:
        pytest.fail(
            f"{_alone.name} starts a process: {event} {arguments[:2]!r:.200}. Test this within one process, "
            "or mark the test with @pytest.mark.process, browser or build."
        )


sys.addaudithook(_keep_to_the_lane)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Watch each test, but not the cells of a notebook, which run in a kernel."""
    global _alone  # noqa: PLW0603 - an audit hook cannot be removed
    marked = any(item.get_closest_marker(lane) for lane in LANES)
    _alone = None if marked or item.path.suffix == ".ipynb" else item
    try:
        return (yield)
    finally:
        _alone = None


def pytest_configure() -> None:
    """Let Ctrl-C end the processes that the tests start, even if pytest itself runs in the background.

    A shell's background job ignores Ctrl-C, and all processes that it starts inherit this.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def program(domain: int) -> Iterator[Callable[..., Program]]:
    """Start ``tank`` with some arguments, in a separate domain, and kill what is left of it at the end.

    Print all output, which pytest shows if the test fails.
    """
    started: list[Program] = []

    def start(*arguments: object, environment: dict[str, str] | None = None) -> Program:
        started.append(Program(*arguments, environment=environment))
        return started[-1]

    yield start
    for running in started:
        status = running.process.poll()  # None while it runs
        running.clear()
        print(f"{running.process.args}, status {status}:\n{running.output}")
