"""Starting the command ``tank`` as a user does, and seeing to it that nothing of it is left."""

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
PATIENCE = 60.0
"""How long a condition may take to come true [s]: long, for both cores may be busy. Only a failing test waits that
long."""


def until(condition: Callable[[], object], what: str = "the condition", patience: float = PATIENCE) -> None:
    """Wait until something is so, and fail if it never is."""
    deadline = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < deadline, f"waited in vain for {what}"
        time.sleep(0.02)


def answer(request: Request | str, patience: float = PATIENCE) -> HTTPResponse:
    """Ask a server for something, as soon as it listens."""
    deadline = time.monotonic() + patience
    while True:
        try:
            return urlopen(request, timeout=patience)
        except URLError as error:
            if not isinstance(error.reason, ConnectionRefusedError) or time.monotonic() > deadline:
                raise
        time.sleep(0.02)


def marked(mark: str) -> list[psutil.Process]:
    """Every process that runs and was started with this mark in ``TANK_TEST_MARK``: it is handed down."""

    def is_marked(process: psutil.Process) -> bool:
        try:
            return process.status() != psutil.STATUS_ZOMBIE and process.environ().get("TANK_TEST_MARK") == mark
        except (psutil.NoSuchProcess, psutil.AccessDenied, psutil.ZombieProcess):
            return False

    return [process for process in psutil.process_iter() if is_marked(process)]


class Program:
    """One running ``tank`` command, its output line by line, and all processes that come from it.

    Args:
        arguments: those of the command.
        environment: variables to add.
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
        """What it has said so far."""
        return "".join(self.lines)

    def says(self, text: str) -> None:
        """Wait until it has said something; what it said instead is told when it does not."""
        with suppress(AssertionError):
            until(lambda: text in self.output or not self._reader.is_alive())
        assert text in self.output, f"waited in vain for {text!r}, it said:\n{self.output}"

    def asks_to_stop(self) -> None:
        """Do what Ctrl-C does."""
        self.process.send_signal(signal.SIGINT)

    def ends(self) -> int:
        """Wait for its end; return its exit status."""
        status = self.process.wait(PATIENCE)
        self._reader.join(PATIENCE)
        return status

    def family(self) -> list[psutil.Process]:
        """Every process that comes from it and still runs, this one included."""
        return marked(self._mark)

    def leaves_nothing(self) -> None:
        """Wait until none of its processes is left."""
        until(lambda: not self.family(), f"the end of {self.family()}")

    def clear(self) -> None:
        """Kill what is left of it."""
        for process in self.family():
            process.kill()
        self.process.wait()
        self._reader.join(PATIENCE)
        self.process.stdout.close()

    def _read(self) -> None:
        for line in self.process.stdout:
            self.lines.append(line)


def need_sandbox_here() -> None:
    """Skip the test where there is no sandbox, and say why; in CI (CI=true) the program for it has to be there."""
    from tutorial.commands.checking.sandbox import need_sandbox
    from tutorial.errors import TutorialError

    try:
        need_sandbox()
    except TutorialError as error:
        (pytest.fail if os.environ.get("CI") == "true" and not shutil.which("bwrap") else pytest.skip)(str(error))
