"""Judges one notebook, in separate processes inside a sandbox."""

import asyncio
import math
import os
import signal
import site
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple, TypeVar

import msgspec
import psutil

from tutorial.commands.checking.messages import FORGED, Judged, Opened, Outcome
from tutorial.commands.checking.sandbox import sandbox
from tutorial.system.parent_watch import signal_group
from tutorial.system.paths import PACKAGE

LARGEST = 50 << 20  # maximum size of a notebook in bytes
OUTLAST = 4  # the CPU time limit as a multiple of the time limit: an answer can use several threads
MEMORY = 8 << 30  # [bytes] limit for the total address space of an answer's processes, including shared memory
LOOK = 0.1  # [s] between checks of the memory
UNREAD = "it could not be read: the process that reads it crashed or took too long"
ENDLESS = "The answer did not finish within {limit:g} s."
DISTURBED = "The answer interfered with the process that judged it."
BROKEN = (
    "The answer stopped the process that judged it, or the answer's processes used more than 8 GB of memory in total."
)
KEPT = (
    *("PATH", "LANG", "LC_", "TZ", "PYTHONPATH", "LD_LIBRARY_PATH", "DYLD_", "VIRTUAL_ENV", "CONDA_PREFIX"),
    *("ROS_", "RMW_", "AMENT_", "CYCLONEDDS_", "FASTDDS_", "FASTRTPS_", "TUTORIAL_"),
)
"""Prefixes of the environment variables that a learner's code can see; other variables can hold keys and passwords."""


T = TypeVar("T", Judged, Opened)


class Submission(NamedTuple):
    """The verdicts on a notebook that a learner has handed in, and the notebook's driver.

    Attributes:
        verdicts: the verdicts by exercise name, in the notebook's order. A problem with the notebook itself, if
            there is one, comes first, under the name "".
        driver: the program for the race; empty if the notebook has none.
    """

    verdicts: dict[str, Judged]
    driver: str


async def judge(path: Path, limit: float, is_sandboxed: bool = True) -> Submission:
    """Judge a notebook's answers, each in a separate process.

    Args:
        path: the notebook.
        limit: the time limit per answer [s].
        is_sandboxed: whether to use a sandbox.
    """
    judged: dict[str, Judged] = {}
    driver = ""
    if not path.is_file():
        problem = "it is not a file"
    elif path.stat().st_size > LARGEST:
        problem = f"it is larger than {LARGEST >> 20} MB"
    else:
        try:
            opened = await _told(Opened, path, limit, is_sandboxed)
            problem, driver = opened.problem, opened.driver
            for exercise in opened.exercises:
                judged[exercise] = await _judge_one(path, exercise, limit, is_sandboxed)
        except (EOFError, TimeoutError, ValueError, RecursionError):
            problem = UNREAD
        except OSError as error:
            problem = f"it cannot be judged: {error.strerror}"
    return Submission(({"": Judged(Outcome.NOT_JUDGED, problem, problem)} if problem else {}) | judged, driver)


async def _judge_one(path: Path, exercise: str, limit: float, is_sandboxed: bool) -> Judged:
    """Judge one answer; if it takes too long, or ends or disturbs its process, the verdict is "not judged"."""
    try:
        judged = await _told(Judged, path, limit, is_sandboxed, exercise)
    except (EOFError, TimeoutError, ValueError, RecursionError) as error:
        why = {EOFError: BROKEN, TimeoutError: ENDLESS.format(limit=limit)}.get(type(error), DISTURBED)
        return Judged(Outcome.NOT_JUDGED, why, why)
    if judged.outcome is Outcome.SCORED or judged.score is not None:  # only a race has a score
        return Judged(Outcome.NOT_JUDGED, FORGED, judged.text)
    return judged


async def _told(kind: type[T], path: Path, limit: float, is_sandboxed: bool, *exercise: str) -> T:
    """Run a process that reads a notebook or judges an answer, kill it and its children, and return its message.

    Raises:
        EOFError: the process wrote nothing.
        OSError: the notebook cannot be opened.
        TimeoutError: the process took too long.
        ValueError, RecursionError: the output of the process is not exactly one message.
    """
    with tempfile.TemporaryDirectory(prefix="tank-check-", ignore_cleanup_errors=True) as folder, path.open() as file:
        command = asyncio.create_subprocess_exec(
            *(sandbox(folder) if is_sandboxed else ()),
            *(sys.executable, "-P", "-m", "tutorial.commands.checking._child"),
            *map(str, (file.fileno(), math.ceil(OUTLAST * limit), is_sandboxed, *exercise)),
            stdin=asyncio.subprocess.PIPE,  # the child ends when this process closes the pipe or exits
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            limit=1 << 18,  # bytes per message
            pass_fds=[file.fileno()],
            start_new_session=True,
            cwd=folder,
            env=environment(folder),
        )
        starting = asyncio.ensure_future(command)  # a cancelled start might never return
        try:
            async with asyncio.timeout(limit):
                process = await asyncio.shield(starting)
                assert process.stdout is not None
                looking = asyncio.create_task(bound_memory(process.pid))  # also ends when the process ends
                line = await process.stdout.readline()
                more = await process.stdout.read(1)
                looking.cancel()
        finally:
            process = await starting
            signal_group(process.pid, signal.SIGKILL)
            await process.wait()
    if not line:
        raise EOFError
    if more:
        raise ValueError(more)
    return msgspec.json.decode(line, type=kind)


async def bound_memory(pid: int) -> None:
    """Watch the memory of a process and its descendants until it ends; kill them if they use too much."""
    with suppress(psutil.NoSuchProcess):
        first = psutil.Process(pid)
        while sum(map(_mapped, (first, *first.children(recursive=True)))) <= MEMORY:
            await asyncio.sleep(LOOK)
        signal_group(pid, signal.SIGKILL)


def _mapped(process: psutil.Process) -> int:
    """Return the size of a process's address space [bytes]; 0 if the process has ended.

    On macOS, where the address space is always hundreds of GB, return the resident memory instead.
    """
    with suppress(psutil.Error):
        return int(getattr(process.memory_info(), "rss" if sys.platform == "darwin" else "vms"))
    return 0


def environment(folder: str) -> dict[str, str]:
    """Return the environment variables for an untrusted program whose files are in the given folder."""
    home = os.pathsep.join(filter(None, (str(PACKAGE.parent), os.environ.get("PYTHONPATH"))))
    return {
        **{name: value for name, value in os.environ.items() if name.startswith(KEPT)},
        **{"HOME": folder, "TMPDIR": folder, "PYTHONPATH": home, "PYTHONUSERBASE": site.getuserbase()},
        **{"PYTHONUTF8": "1", "PYTHONDONTWRITEBYTECODE": "1"},
        **{"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},  # each thread needs memory, which is limited
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
