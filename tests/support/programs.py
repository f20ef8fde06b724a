"""Start the command ``tank`` as a user does, and check that nothing of it is left."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Callable
from contextlib import suppress
from http.client import HTTPResponse
from pathlib import Path
from urllib.error import URLError
from urllib.request import Request, urlopen

import psutil
import pytest

TANK = str(Path(sys.executable).parent / "tank")
TIMEOUT = 60.0
"""How long a condition may take to come true [s]. Both cores may be busy, and only a failing test waits so
long."""


def until(condition: Callable[[], object], what: str = "the condition", timeout: float = TIMEOUT) -> None:
    """Wait until a condition holds, and fail if it never does."""
    deadline = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < deadline, f"timed out waiting for {what}"
        time.sleep(0.02)


def answer(request: Request | str, timeout: float = TIMEOUT) -> HTTPResponse:
    """Send a request to a server as soon as it listens."""
    deadline = time.monotonic() + timeout
    while True:
        try:
            return urlopen(request, timeout=timeout)
        except URLError as error:
            if not isinstance(error.reason, ConnectionRefusedError) or time.monotonic() > deadline:
                raise
        time.sleep(0.02)


def marked(mark: str) -> list[psutil.Process]:
    """Return every running process with this mark in ``TANK_TEST_MARK``, which children inherit."""

    def is_marked(process: psutil.Process) -> bool:
        try:
            return process.status() != psutil.STATUS_ZOMBIE and process.environ().get("TANK_TEST_MARK") == mark
        except (psutil.NoSuchProcess, psutil.AccessDenied, psutil.ZombieProcess):
            return False

    return [process for process in psutil.process_iter() if is_marked(process)]


class Program:
    """A running ``tank`` command with its lines of output and all its descendants.

    Args:
        arguments: the command's arguments.
        environment: additional variables.
    """

    def __init__(self, *arguments: object, environment: dict[str, str] | None = None) -> None:
        self._mark = uuid.uuid4().hex
        self.lines: list[str] = []
        self.process = subprocess.Popen(
            [TANK, *map(str, arguments)],
            env={**os.environ, **(environment or {}), "TANK_TEST_MARK": self._mark},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def output(self) -> str:
        """Its output so far."""
        return "".join(self.lines)

    def says(self, text: str) -> None:
        """Wait until it has printed a text; if it ends first, fail with its output."""
        with suppress(AssertionError):
            until(lambda: text in self.output or not self._reader.is_alive())
        assert text in self.output, f"timed out waiting for {text!r}; it printed:\n{self.output}"

    def asks_to_stop(self) -> None:
        """Press Ctrl-C."""
        self.process.send_signal(signal.SIGINT)

    def ends(self) -> int:
        """Wait until it exits, and return its exit status."""
        status = self.process.wait(TIMEOUT)
        self._reader.join(TIMEOUT)
        return status

    def family(self) -> list[psutil.Process]:
        """Return it and all its descendants that are still running."""
        return marked(self._mark)

    def leaves_nothing(self) -> None:
        """Wait until all its processes have ended."""
        until(lambda: not self.family(), f"the end of {self.family()}")

    def clear(self) -> None:
        """Kill what is left of it."""
        for process in self.family():
            process.kill()
        self.process.wait()
        self._reader.join(TIMEOUT)
        self.process.stdout.close()

    def _read(self) -> None:
        for line in self.process.stdout:
            self.lines.append(line)


def need_sandbox_here() -> None:
    """Skip the test without a sandbox, with the reason; in CI (CI=true) bubblewrap must be installed."""
    from tutorial.commands.checking.sandbox import need_sandbox
    from tutorial.errors import TutorialError

    try:
        need_sandbox()
    except TutorialError as error:
        (pytest.fail if os.environ.get("CI") == "true" and not shutil.which("bwrap") else pytest.skip)(str(error))
