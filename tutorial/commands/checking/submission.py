"""Having one notebook judged, in a process of its own that a sandbox holds."""

from __future__ import annotations

import asyncio
import math
import os
import signal
import site
import sys
import tempfile
from collections.abc import AsyncGenerator, Sequence
from contextlib import aclosing
from dataclasses import dataclass, field
from pathlib import Path

import msgspec

from tutorial.commands.checking.messages import Done, Judged, Message, Opened, Outcome, Trying, Unreadable
from tutorial.commands.checking.sandbox import sandbox
from tutorial.parent_watch import signal_group
from tutorial.paths import PACKAGE

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

    @property
    def verdicts(self) -> list[Judged]:
        """What became of the answers; first of the whole, if that could not be judged, without an exercise's name."""
        whole = [Judged("", Outcome.NOT_JUDGED, self.problem, self.problem)] if self.problem else []
        return [*whole, *self.judged.values()]


async def judge(path: Path, limit: float, is_sandboxed: bool = True) -> Submission:
    """Have a notebook's answers judged.

    An answer that takes too long, or ends the process, is charged with that, and the others are judged in another one.

    Args:
        path: the file.
        limit: how long an answer may take [s].
        is_sandboxed: whether a sandbox holds it.
    """
    submission = Submission(path)
    if not path.is_file():
        submission.problem = "it is no file"
    elif path.stat().st_size > LARGEST:
        submission.problem = f"it has more than {LARGEST >> 20} MB"
    else:
        try:
            with path.open("rb", buffering=0) as notebook:
                while await _judge_on(submission, notebook.fileno(), limit, is_sandboxed):
                    notebook.seek(0)
        except OSError as error:
            submission.problem = f"it cannot be judged: {error.strerror}"
    return submission


async def _judge_on(submission: Submission, notebook: int, limit: float, is_sandboxed: bool) -> bool:
    """Judge what is not judged yet, in one process; return whether something is left that another one can do."""
    left: set[str] | None = None  # the exercises that are not judged yet, when the notebook is read
    tried, why = "", BROKEN
    try:
        async with aclosing(_messages(notebook, tuple(submission.judged), limit, is_sandboxed)) as messages:
            async for message in messages:
                match message:
                    case Unreadable() if left is None:
                        submission.problem = message.why
                        return False
                    case Opened() if left is None:
                        left = set(message.exercises) - submission.judged.keys()
                    case Trying(exercise=name) if left and name in left and tried not in left:
                        tried = name
                    case Judged(exercise=name) if left and name in left and name == tried:
                        submission.judged[name] = message
                        left.remove(name)
                    case Done() if left == set():
                        return False
                    case _:  # it is not its turn, so it is the answer's and not the process's
                        raise ValueError(message)
    except TimeoutError:
        why = ENDLESS.format(limit=limit)
    except (ValueError, msgspec.MsgspecError):
        why = DISTURBED
    if left is None or not tried:
        submission.problem = "it could not be read: the process that reads it has ended, or taken too long"
        return False
    submission.judged[tried] = Judged(tried, Outcome.NOT_JUDGED, why, why)
    return bool(left - {tried})


async def _messages(notebook: int, done: Sequence[str], limit: float, is_sandboxed: bool) -> AsyncGenerator[Message]:
    """Start the process, and yield what it tells; nothing of it is left afterwards.

    Raises:
        TimeoutError: it has not told anything for too long.
        ValueError, msgspec.MsgspecError: what it has told is no message.
    """
    with tempfile.TemporaryDirectory(prefix="tank-check-", ignore_cleanup_errors=True) as folder:
        words = map(str, (notebook, math.ceil(OUTLAST * limit), is_sandboxed, *done))
        process = await asyncio.create_subprocess_exec(
            *(sandbox(folder) if is_sandboxed else ()),
            *(sys.executable, "-P", "-m", "tutorial.commands.checking._child", *words),
            stdin=asyncio.subprocess.PIPE,  # its end tells the process that this one is gone
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.DEVNULL,
            limit=LINE,
            pass_fds=[notebook],
            start_new_session=True,
            cwd=folder,
            env=_environment(folder),
        )
        assert process.stdout is not None
        try:
            while True:
                async with asyncio.timeout(limit):
                    line = await process.stdout.readline()
                if not line:
                    return
                yield msgspec.json.decode(line, type=Message)
        finally:
            signal_group(process.pid, signal.SIGKILL)
            await process.wait()


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
