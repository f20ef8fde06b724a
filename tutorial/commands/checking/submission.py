"""Having one notebook judged, in a process of its own that a sandbox holds."""

from __future__ import annotations

import asyncio
import math
import os
import signal
import site
import stat
import subprocess
import sys
import tempfile
from collections.abc import AsyncGenerator, Iterator, Sequence
from contextlib import aclosing, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from tutorial.commands.checking.messages import Done, Judged, Message, Opened, Outcome, Trying, Unreadable, clean
from tutorial.commands.checking.sandbox import sandbox
from tutorial.paths import PACKAGE
from tutorial.ros.domains import shared_folder

__all__ = ["Submission", "judge"]

LARGEST = 50 << 20  # bytes of a notebook
LINE = 1 << 16  # bytes of a message
OUTLAST = 4  # times its limit that an answer may take of the processor: two threads and more may be at work
ENDLESS = "The answer did not come to its end within {limit:g} s."
DISTURBED = "The answer has disturbed the process that judged it."
BROKEN = "The answer ended the process that judged it."
KEPT = (
    *("PATH", "LANG", "LC_", "TZ", "PYTHONPATH", "LD_LIBRARY_PATH", "DYLD_", "VIRTUAL_ENV", "CONDA_PREFIX"),
    *("ROS_", "RMW_", "AMENT_", "CYCLONEDDS_", "FASTDDS_", "FASTRTPS_", "TUTORIAL_"),
)
"""What variables begin with that a learner's code may see; others may hold keys and passwords."""


@dataclass
class Submission:
    """A notebook, and what became of its answers.

    Attributes:
        path: the file.
        judged: by the exercise's name, in the notebook's order.
        problem: why it could not be judged as a whole; else empty.
    """

    path: Path
    judged: dict[str, Judged] = field(default_factory=dict)
    problem: str = ""


async def judge(path: Path, limit: float, is_sandboxed: bool = True) -> Submission:
    """Have a notebook's answers judged.

    An answer that takes too long, or ends the process, is charged with that, and the others are judged in another one.

    Args:
        path: the file.
        limit: how long an answer may take [s].
        is_sandboxed: whether a sandbox holds it.
    """
    submission = Submission(path)
    try:
        notebook = _opened(path)
    except OSError as error:
        submission.problem = f"it cannot be opened: {error.strerror}"
        return submission
    try:
        while await _goes_on(submission, notebook, limit, is_sandboxed):
            os.lseek(notebook, 0, os.SEEK_SET)
    except OSError as error:
        submission.problem = f"it could not be judged: {error}"
    finally:
        os.close(notebook)
    return submission


def _opened(path: Path) -> int:
    """Open a file, and nothing else that may be there, such as a pipe that never ends.

    Raises:
        OSError: it is none, or too large.
    """
    fd = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    status = os.fstat(fd)
    if not stat.S_ISREG(status.st_mode) or status.st_size > LARGEST:
        os.close(fd)
        raise OSError(0, f"it has more than {LARGEST >> 20} MB" if stat.S_ISREG(status.st_mode) else "it is no file")
    return fd


async def _goes_on(submission: Submission, notebook: int, limit: float, is_sandboxed: bool) -> bool:
    """Judge what is not judged yet, in one process; return whether something is left that another one can do."""
    state = _State(submission)
    why = BROKEN
    try:
        async with aclosing(_messages(notebook, tuple(submission.judged), limit, is_sandboxed)) as messages:
            async for message in messages:
                state.take(message)
    except TimeoutError:
        why = ENDLESS.format(limit=limit)
    except (ValueError, msgspec.MsgspecError):
        why = DISTURBED
        state.trying = state.trying or state.last
    if state.trying:
        submission.judged[state.trying] = Judged(state.trying, Outcome.NOT_JUDGED, why, why)
        return bool(state.left - {state.trying})
    if state.left or not state.opened:
        submission.problem = "it could not be read: the process that reads it has ended, or taken too long"
    return False


class _State:
    """How far a process has come with a notebook, and what comes next.

    Args:
        submission: is told what becomes of its answers.

    Attributes:
        opened: whether the notebook is read.
        left: the exercises that are not judged yet.
        trying: the one whose answer is being run; empty for none.
        last: the one whose answer was run before.
    """

    def __init__(self, submission: Submission) -> None:
        self._submission = submission
        self.opened = False
        self.left: set[str] = set()
        self.trying = self.last = ""

    def take(self, message: Message) -> None:
        """Take in a message.

        Raises:
            ValueError: it is not its turn, so it is the answer's and not the process's.
        """
        submission = self._submission
        match message:
            case Unreadable() if not self.opened:
                submission.problem = message.why
            case Opened() if not self.opened:
                self.left = set(message.exercises) - submission.judged.keys()
            case Trying(exercise=name) if name in self.left and not self.trying:
                self.trying = name
            case Judged(exercise=name) if name == self.trying != "":
                cause, text = clean(message.cause), clean(message.text)
                submission.judged[name] = Judged(name, message.outcome, cause, text)
                self.left.discard(name)
                self.trying, self.last = "", name
            case _:
                raise ValueError(message)
        self.opened = True


async def _messages(notebook: int, done: Sequence[str], limit: float, is_sandboxed: bool) -> AsyncGenerator[Message]:
    """Start the process, and yield what it tells; nothing of it is left afterwards.

    Raises:
        TimeoutError: it has not told anything for too long.
        ValueError, msgspec.MsgspecError: what it has told is no message.
    """
    loop = asyncio.get_running_loop()
    read_end, write_end = os.pipe()
    with _running(notebook, write_end, done, limit, is_sandboxed):
        os.close(write_end)
        reader = asyncio.StreamReader(LINE)
        transport, _ = await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), os.fdopen(read_end))
        try:
            while True:
                async with asyncio.timeout(limit):
                    line = await reader.readline()
                message = msgspec.json.decode(line, type=Message) if line else Done()
                if isinstance(message, Done):
                    return
                yield message
        finally:
            transport.close()


@contextmanager
def _running(notebook: int, report: int, done: Sequence[str], limit: float, is_sandboxed: bool) -> Iterator[None]:
    with tempfile.TemporaryDirectory(prefix="tank-check-", ignore_cleanup_errors=True) as folder:
        if not is_sandboxed:  # then its ROS domain has to be another one than everybody else's
            (Path(folder) / shared_folder().name).symlink_to(shared_folder())
        words = [report, notebook, math.ceil(OUTLAST * limit), is_sandboxed, *done]
        command = [sys.executable, "-P", "-m", "tutorial.commands.checking._child", *map(str, words)]
        process = subprocess.Popen(
            [*(sandbox(folder) if is_sandboxed else ()), *command],
            stdin=subprocess.PIPE,  # its end tells the process that this one is gone
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=[report, notebook],
            start_new_session=True,
            cwd=folder,
            env=_environment(folder),
        )
        with process:
            try:
                yield
            finally:
                with suppress(ProcessLookupError, PermissionError):  # PermissionError: what macOS says of a zombie
                    os.killpg(process.pid, signal.SIGKILL)


def _environment(folder: str) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if name.startswith(KEPT)}
    home = os.pathsep.join(filter(None, (str(PACKAGE.parent), os.environ.get("PYTHONPATH"))))
    return {
        **kept,
        **{"HOME": folder, "TMPDIR": folder, "PYTHONPATH": home, "PYTHONUSERBASE": site.getuserbase()},
        **{"PYTHONUTF8": "1", "PYTHONDONTWRITEBYTECODE": "1"},
        **{"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},  # each thread takes memory, of which there is a limit
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
