"""What all tests share. `tutorial` comes first: it is what makes rclpy importable."""

import signal
import sys
from collections.abc import Callable, Iterator

import pytest
from programs import Program

import tutorial  # noqa: F401

LANES = ("process", "browser", "build", "ros2", "nightly")
"""The marks of tests that may start processes; pyproject.toml says what each means, the Makefile which command runs
which."""

STARTS = {"os.fork", "os.forkpty", "os.posix_spawn", "os.system", "subprocess.Popen"}
"""What Python's audit events call the start of a process."""

_alone: pytest.Item | None = None  # the test that runs, where it may start nothing


def _keep_to_the_lane(event: str, arguments: tuple[object, ...]) -> None:
    """Fail a test that starts a process and has no mark that says so."""
    if event in STARTS and _alone is not None:
        pytest.fail(
            f"{_alone.name} starts a process: {event} {arguments[:2]!r:.200}. Prove it within one process, "
            "or mark the test with @pytest.mark.process, browser or build."
        )


sys.addaudithook(_keep_to_the_lane)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Around each test, but not around the cells of a notebook, which run in a kernel."""
    global _alone  # noqa: PLW0603 - an audit hook stays for good
    marked = any(item.get_closest_marker(lane) for lane in LANES)
    _alone = None if marked or item.path.suffix == ".ipynb" else item
    try:
        return (yield)
    finally:
        _alone = None


def pytest_configure() -> None:
    """Have Ctrl-C end what the tests start, however they themselves were started.

    A background job of a shell ignores it, and so would every process that the tests start: this is handed down.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def program(domain: int) -> Iterator[Callable[..., Program]]:
    """Start ``tank`` with some arguments, in a domain of its own; what is left of it in the end is killed.

    What all of them said is shown where the test has failed.
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
