"""Commands that a cell runs in separate processes, so that no second terminal is needed."""

import os
import shlex
import shutil
import signal
import subprocess
import threading
from collections import deque

from tutorial.errors import TutorialError
from tutorial.notebook.desk import until
from tutorial.system import parent_watch
from tutorial.system.paths import HOME, with_own_commands

TIMEOUT = 5.0  # [s] between asking a command to stop and killing it
LONGEST = 120.0  # [s] maximum time to wait for a command to exit by itself
LINES_KEPT = 1000


class Command:
    """A command that runs in its own process, in the tutorial's folder. It stops when the kernel exits or is killed.

    Args:
        line: the command line, for instance ``"tank run step2 --headless"``.

    Raises:
        TutorialError: there is no such command.
    """

    def __init__(self, line: str) -> None:
        self._line = line
        self._kept: deque[str] = deque(maxlen=LINES_KEPT)
        self._process = _start(line)
        self._reader = threading.Thread(target=self._read, name=f"reader of {line}", daemon=True)
        self._reader.start()

    def __repr__(self) -> str:
        return f"Command({self._line!r})"

    @property
    def output(self) -> str:
        """The text that the command has printed so far."""
        return "".join(tuple(self._kept))

    @property
    def status(self) -> int | None:
        """The exit status; None while the command runs."""
        return self._process.returncode

    async def says(self, text: str) -> None:
        """Wait until the command has printed `text`.

        Raises:
            TutorialError: the command exited without printing `text`, or took too long.
        """
        await until(lambda: text in self.output or not self._reader.is_alive(), f"{self._line!r} to print {text!r}")
        if text not in self.output:
            raise TutorialError(f"{self._line!r} ended with status {self.status}. It printed:\n{self.output}")

    async def ends(self) -> int:
        """Wait until the command exits on its own, and return its exit status."""
        await until(lambda: not self._reader.is_alive(), f"the end of {self._line!r}", LONGEST)
        return self._process.returncode

    def close(self) -> None:
        """Stop the command as Ctrl-C does, and kill it if it doesn't stop in time. Idempotent."""
        for number in (signal.SIGINT, signal.SIGKILL):
            if self._reader.is_alive():
                parent_watch.signal_group(self._process.pid, number)
                self._reader.join(TIMEOUT)

    def _read(self) -> None:
        """Store the command's output until the command ends."""
        with self._process:  # leaving the block closes the streams, and waits for the process
            self._kept.extend(self._process.stdout or ())


def _start(line: str) -> subprocess.Popen[str]:
    words = shlex.split(line)
    environment = with_own_commands(os.environ)
    if not words or shutil.which(words[0], path=environment["PATH"]) is None:
        raise TutorialError(
            f"there is no command {line!r}. Write the command as in a terminal: start_command('tank joy')."
        )
    return parent_watch.start_watched(words, environment, HOME)
