"""Runs ROS 2 launch files without ROS 2 and prints the output of each process."""

from __future__ import annotations

import os
import runpy
import shutil
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import datetime
from importlib import import_module
from itertools import chain, count
from pathlib import Path
from subprocess import Popen
from types import ModuleType
from typing import TYPE_CHECKING, TextIO

import pocket_ros2
from tutorial.commands.terminal import handle_signals
from tutorial.errors import TutorialError, describe_error, printable, printable_lines
from tutorial.system import parent_watch
from tutorial.system.paths import with_own_commands

if TYPE_CHECKING:
    from launch.actions import ExecuteProcess

TIMEOUT = 8.0  # [s] between asking a process to stop and killing it
LOOK_EVERY = 0.1  # [s] between checks of the running processes


def load_launch_file(path: Path) -> list[ExecuteProcess]:
    """Read the list of processes from a launch file.

    The file is run with the `launch` of the pocket ROS 2, even if a real ROS 2 is installed, so that ``tank launch``
    behaves the same on every machine.

    Raises:
        TutorialError: the file fails, uses more of `launch` than the tutorial supports, or describes a process that
            cannot be started; the error gives the line if possible.
    """
    with _own_launch() as launch:
        try:
            description = runpy.run_path(str(path)).get("generate_launch_description", lambda: None)()
        except ImportError as error:
            reason = str(error).removesuffix(".")
            fix = f"Run it with a real ROS 2: ros2 launch {path}"
            raise TutorialError(
                f"{path} uses features that the tutorial's version of launch does not support: {reason}. {fix}"
            ) from error
        except (Exception, SystemExit) as error:
            raise TutorialError(f"{path} failed: {describe_error(error, str(path))}") from error
    if not isinstance(description, launch.LaunchDescription) or not description.entities:
        what = "function generate_launch_description() that returns a LaunchDescription with a process"
        raise TutorialError(f"{path} has no {what}.")
    for entity in description.entities:
        if not isinstance(entity, launch.actions.ExecuteProcess):
            raise TutorialError(f"{path} has a {type(entity).__name__}, which needs a real ROS 2: ros2 launch {path}")
        words = entity.cmd if isinstance(entity.cmd, list | tuple) else []
        if not words or not words[0] or not all(isinstance(word, str | Path) for word in words):
            fix = "Give a list of words, such as cmd=['tank', 'joy']."
            raise TutorialError(f"{path} has a process that cannot be started: its cmd is {entity.cmd!r:.100}. {fix}")
    return list(description.entities)


class Launcher:
    """Starts processes, prints their output prefixed with their names, and stops them together.

    When a process fails, the launcher interrupts the other processes and, after a timeout or a second Ctrl-C, kills
    them. No process outlives the launcher, even if the launcher is killed: see `tutorial.system.parent_watch`.

    Args:
        processes: the processes to start.
        environment: variables to add to the processes' environment.
        output: the stream to print to.
    """

    def __init__(self, processes: Sequence[ExecuteProcess], environment: Mapping[str, str], output: TextIO) -> None:
        self._processes = _by_name(processes)
        self._environment = environment
        self._output = output
        self._width = max(map(len, self._processes))
        self._running: dict[str, Popen[str]] = {}
        self._readers: list[threading.Thread] = []
        self._stop = threading.Event()
        self._status = 0
        self.interrupted = False

    def run(self, progress: Callable[[float], object]) -> int:
        """Run the processes until they end.

        Args:
            progress: called repeatedly with the elapsed seconds.

        Returns:
            The exit status of the first process that failed; 0 if no process failed.
        """
        handle_signals(self._interrupt, at_once=lambda: self._signal_groups(signal.SIGKILL))
        began = time.monotonic()
        try:
            for name, process in self._processes.items():
                self._start(name, process)
            while any(reader.is_alive() for reader in self._readers) and not self._stop.wait(LOOK_EVERY):
                progress(time.monotonic() - began)
        finally:
            self._stop_all()
            for reader in self._readers:
                reader.join()
        return self._status

    def _interrupt(self) -> None:
        self.interrupted = True
        self._stop.set()

    def _start(self, name: str, process: ExecuteProcess) -> None:
        """Start a process, and a thread that reads its output."""
        command = [str(word) for word in process.cmd]
        try:
            environment = os.environ if process.env is None else process.env
            environment = with_own_commands({**environment, **self._environment, **(process.additional_env or {})})
            command[0] = shutil.which(command[0], path=environment["PATH"]) or command[0]
            self._running[name] = started = parent_watch.start_watched(command, environment, process.cwd)
        except (OSError, TypeError, ValueError) as error:  # the last two are raised for invalid arguments
            raise TutorialError(f"{name} could not be started: {error}") from error
        reader = threading.Thread(target=self._follow, args=(name, started), daemon=True)
        self._readers.append(reader)
        reader.start()

    def _follow(self, name: str, process: Popen[str]) -> None:
        """Print a process's output until it ends. If it is the first to fail, make `run` stop the other processes."""
        with process:
            for line in process.stdout or ():
                self._say(name, printable_lines(line.rstrip("\n")))
            status = process.wait()
        if status >= 0:  # if a signal killed the process, others in its group may still be running
            self._running.pop(name, None)
        if status and not self._stop.is_set():
            self._status = status if status > 0 else 128 - status
            self._say(name, f"failed with exit status {self._status}; stopping the other processes")
            self._stop.set()

    def _stop_all(self) -> None:
        """Interrupt every remaining process group, and kill those that don't stop in time."""
        self._stop.set()
        self._signal_groups(signal.SIGINT)
        for _ in range(round(TIMEOUT / LOOK_EVERY)):
            if not self._signal_groups(0):
                return
            time.sleep(LOOK_EVERY)
        for name in self._running:
            self._say(name, f"did not stop within {TIMEOUT:g} s; killing it")
        self._signal_groups(signal.SIGKILL)

    def _signal_groups(self, number: int) -> bool:
        """Send a signal to every remaining process group (0 sends nothing); return whether any group remains."""
        for name, process in tuple(self._running.items()):
            if not parent_watch.signal_group(process.pid, number):
                self._running.pop(name, None)
        return bool(self._running)

    def _say(self, name: str, line: str) -> None:
        try:
            self._output.write(f"{datetime.now():%H:%M:%S} {name:{self._width}} | {line}\n")
            self._output.flush()
        except BrokenPipeError:  # the reader, such as head, has exited
            self._stop.set()


def _by_name(processes: Iterable[ExecuteProcess]) -> dict[str, ExecuteProcess]:
    """Name each process after its `name` or, if it has none, its program. Number repeated names to make them unique."""
    named: dict[str, ExecuteProcess] = {}
    for process in processes:
        name = printable(str(process.name or Path(str(process.cmd[0])).name))
        unique = next(each for each in chain([name], (f"{name}-{n}" for n in count(2))) if each not in named)
        named[unique] = process
    return named


@contextmanager
def _own_launch() -> Iterator[ModuleType]:
    """Make ``import launch`` import the pocket ROS 2's module for the duration of the context."""
    hidden = {name: sys.modules.pop(name) for name in tuple(sys.modules) if name.split(".")[0] == "launch"}
    sys.path.insert(0, str(pocket_ros2.PATH))
    try:
        import_module("launch.actions")
        yield sys.modules["launch"]
    finally:
        sys.path.remove(str(pocket_ros2.PATH))
        for name in tuple(sys.modules):
            if name.split(".")[0] == "launch":
                del sys.modules[name]
        sys.modules.update(hidden)
