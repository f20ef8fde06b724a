"""Runs one race: the simulation in this process, and the driver, which is a learner's node, in a separate process."""

from __future__ import annotations

import asyncio
import hashlib
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import AsyncExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import psutil

from tutorial.commands.checking.sandbox import sandbox
from tutorial.commands.checking.submission import bound_memory, environment
from tutorial.controllers.referee import Referee
from tutorial.errors import printable
from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.race.rules import FOUL, Result
from tutorial.ros.domains import reserved_domain
from tutorial.system import parent_watch
from tutorial.system.paths import PACKAGE, original
from tutorial.system.printing import print_text
from tutorial.view.bodies import View
from tutorial.view.replay import recorded
from tutorial.view.scene import Scene
from tutorial.view.web import SceneServer

LIMITED = "from tutorial.commands.checking.sandbox import limit; limit(600, True); "
PRELUDE = (
    "import runpy, sys, tutorial; from pathlib import Path; sys.argv = sys.argv[1:]; "
    "sys.path.insert(0, str(Path(sys.argv[0]).parent)); runpy.run_path(sys.argv[0], run_name='__main__')"
)
"""Runs a file as ``python FILE`` does, after ``import tutorial``, which makes rclpy importable."""

NO_START, DRIVER_ENDED = "no start", "driver ended"
CHANGED = "the line or the tutorial's files have changed"
SLOW = 0.95  # simulated time divided by real time: below this, a driver gets its images late
SLOWEST = 0.2  # below this, a race ends early
LOOK = 0.05  # [s] between checks of the driver
MEET_FOR = 20.0  # [s] maximum time to wait for a driver's publisher; imports are slow on a loaded machine
STOP_WITHIN = 2.0  # [s] between asking a driver to stop and killing it
LINES_KEPT, LONGEST_LINE = 50, 10_000  # number of output lines to keep, and their maximum length; longer ones are split
MOST = 1_000_000  # maximum number of characters that a driver can print
MARK = "TANK_RACE"  # environment variable that a driver's processes inherit


@dataclass(frozen=True)
class Entry:
    """One row of the score table.

    Attributes:
        driver: the driver's file.
        layout: the name of the line.
        result: the referee's result.
        note: the problem with the driver or the race; empty if there was none.
        real_time: simulated time divided by real time; if it is below 1, the machine was too slow for a fair race.
    """

    driver: str
    layout: str
    result: Result
    note: str = ""
    real_time: float = 0.0

    @property
    def warning(self) -> str:
        """A warning if the machine was too slow for a fair race; otherwise an empty string."""
        if self.real_time >= SLOW or self.result.seconds < 1:  # in a shorter race, the ratio mostly reflects the start
            return ""
        return f"raced at {self.real_time:.2f} times real time: race again with nothing else running on this machine"

    def as_dict(self) -> dict[str, Any]:
        """Return the entry as a dictionary for JSON."""
        entry = {"driver": self.driver, "layout": self.layout, **self.result.as_dict()}
        return {**entry, "note": self.note, "real_time": round(self.real_time, 3)}


@dataclass(frozen=True)
class Options:
    """How to run races.

    Attributes:
        line: the file that defines the line.
        view: whether to serve a 3D view.
        limit: the maximum duration of a race [s], in simulated time.
        loud: whether to print the driver's output on stderr.
        is_sandboxed: whether the driver runs in a sandbox.
        fingerprint: the value of `fingerprint` before the first race.
    """

    line: Path
    view: bool
    limit: float
    loud: bool
    is_sandboxed: bool
    fingerprint: bytes


class Driver:
    """A driver's program and all processes that it starts.

    Args:
        path: the Python file.
        hear: called with each line of the program's output, on a separate thread.
        is_sandboxed: whether the program runs in a sandbox, where it cannot change any files.
    """

    def __init__(self, path: Path, hear: Callable[[str], object], is_sandboxed: bool) -> None:
        self._mark = uuid.uuid4().hex
        self._lines: deque[str] = deque(maxlen=LINES_KEPT)
        self._hear = hear
        self._folder = tempfile.TemporaryDirectory(prefix="tank-race-", ignore_cleanup_errors=True)
        if is_sandboxed:
            words, variables = sandbox(self._folder.name, path.resolve()), environment(self._folder.name)
            code = LIMITED + PRELUDE
        else:
            words, variables = [], dict(os.environ)
            code = PRELUDE
        command = [*words, sys.executable, "-P", "-c", code, str(path.resolve())]
        self._process = parent_watch.start_watched(command, {**variables, MARK: self._mark})
        self._reader = threading.Thread(target=self._read, name="driver", daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int:
        """The ID of the program's first process."""
        return self._process.pid

    @property
    def ended(self) -> bool:
        """Whether the driver's program has ended."""
        return self._process.poll() is not None

    def how_it_ended(self) -> str:
        """Describe how the driver's program ended. After an error, quote the last line of the traceback."""
        self._reader.join(STOP_WITHIN)
        if not self._process.returncode:
            return "the driver's program has ended"
        if self._process.returncode == -signal.SIGKILL:
            return "the driver's program was killed, for instance because its processes used too much memory"
        last = next((line for line in reversed(self._lines) if line.strip()), "")
        return printable(last.strip()) or f"the driver's program exited with status {self._process.returncode}"

    def close(self) -> None:
        """Ask the program to stop, and then kill its remaining processes, including those that have left its group.

        Outside a sandbox, a process survives if its parent has exited and its environment no longer contains `MARK`.
        """
        self._hear = lambda _: None  # Ctrl-C can make the driver print a traceback
        before = self._family()
        parent_watch.signal_group(self._process.pid, signal.SIGINT)
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(STOP_WITHIN)
        parent_watch.signal_group(self._process.pid, signal.SIGKILL)
        for process in before | self._family():
            with suppress(psutil.Error):
                process.kill()
        self._process.wait()
        self._reader.join(STOP_WITHIN)
        self._folder.cleanup()

    def _family(self) -> set[psutil.Process]:
        """Return the program's descendants, and all processes whose environment contains its mark."""
        family: set[psutil.Process] = set()
        with suppress(psutil.Error):
            family.update(psutil.Process(self._process.pid).children(recursive=True))
        for process in psutil.process_iter():
            with suppress(psutil.Error):
                if process.environ().get(MARK) == self._mark:
                    family.add(process)
        return family

    def _read(self) -> None:
        with self._process as process:
            assert process.stdout is not None
            count = 0
            for line in iter(partial(process.stdout.readline, LONGEST_LINE), ""):
                self._lines.append(line)
                count += len(line)
                if count <= MOST:
                    self._hear(line)
                elif count <= MOST + len(line):
                    self._hear("The rest of the driver's output is not shown.\n")


async def race(path: Path, name: str, html: Path | None, project: Project, options: Options) -> Entry:
    """Run one race in a separate ROS domain, then stop everything that the race started.

    Args:
        path: the driver's file.
        name: the driver's name.
        html: where to write a page that replays the race; None to write no page.
        project: a project with a `Referee`.
        options: how to run the race.

    Raises:
        TutorialError: the world is not suitable for a race, or a file cannot be written.
    """
    layout = options.line.stem
    async with AsyncExitStack() as stack:
        stack.enter_context(_own_domain())
        scene = Scene()
        view = View(scene) if options.view or html else None
        host = await stack.enter_async_context(Host(project, None, view))
        if options.view:
            server = await stack.enter_async_context(SceneServer(scene, title="race"))
            print_text(f"3D view: {server.url}\n")
        if html is not None:
            stack.enter_context(recorded(scene, html, f"{name}, {layout}", host.shown_at, host.joint_positions))
        hear = partial(print_text, err=True) if options.loud else (lambda _: None)
        driver = Driver(path, hear, options.is_sandboxed)
        stack.callback(driver.close)
        if options.is_sandboxed:
            stack.callback(asyncio.create_task(bound_memory(driver.pid)).cancel)
        if problem := await _meet(host, driver):
            result, note, real_time = Result(end=NO_START), problem, 0.0
        else:
            referee = host.controllers["Referee"]
            assert isinstance(referee, Referee)
            referee.limit = options.limit
            note, real_time = await _run(host, referee, driver)
            result = replace(referee.race.result, end=referee.race.result.end or DRIVER_ENDED)
        if fingerprint(options.line) != options.fingerprint:
            result = replace(result, end=FOUL, foul=CHANGED)
        return Entry(name, layout, result, result.foul or note, real_time)


@contextmanager
def _own_domain() -> Iterator[None]:
    """Reserve a ROS domain for the simulation and for the driver, which inherits it through environment variables."""
    with reserved_domain(os.environ.get("ROS_DOMAIN_ID")) as domain:
        os.environ |= {"ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        yield


async def _meet(host: Host, driver: Driver) -> str:
    """Wait until a driver has a publisher on ``/joy``. Return "", or the reason why no publisher was found."""
    deadline = time.monotonic() + MEET_FOR
    topic = host.node.resolve_topic_name("joy")
    while not host.node.count_publishers(topic):
        if driver.ended:
            return driver.how_it_ended()
        if time.monotonic() > deadline:
            return f"the driver did not create a publisher on {topic} within {MEET_FOR:g} s"
        await asyncio.sleep(LOOK)
    return ""


async def _run(host: Host, referee: Referee, driver: Driver) -> tuple[str, float]:
    """Run a race to its end. Return why it ended early ("" if it did not), and simulated time divided by real time."""
    simulation = host.simulation
    assert simulation is not None
    simulation.advance(simulation.time_step)  # in lockstep, this waits for the first image, and for OpenGL to start

    began, from_time = time.perf_counter(), simulation.time
    longest = referee.limit / SLOWEST

    def look(_: float) -> None:
        if referee.race.over or driver.ended or time.perf_counter() - began > longest:
            simulation.stop()

    await host.run(referee.limit, progress=look)
    real_time = (simulation.time - from_time) / (time.perf_counter() - began)
    if referee.race.over:
        return "", real_time
    return (
        driver.how_it_ended() if driver.ended else f"this machine is too slow: the race ended after {longest:g} s",
        real_time,
    )


def fingerprint(line: Path) -> bytes:
    """Return a hash of the files that affect a race: its line, and the tutorial's code, projects and models."""
    digest = hashlib.sha256()
    files = (*PACKAGE.rglob("*.py"), *(PACKAGE / "view" / "static").rglob("*"), *(original() / "project").rglob("*.*"))
    for path in (line, *filter(Path.is_file, sorted(files))):
        digest.update(f"{path} {path.stat().st_size}\n".encode() + path.read_bytes())
    return digest.digest()
