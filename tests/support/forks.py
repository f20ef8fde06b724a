"""Judge answers in forks of one process that has already imported everything, instead of in new interpreters.

There are hundreds of mutants. Judging one in a fork takes a fifth of the time, partly because it searches for no cause.
Otherwise a mutant runs like a learner's answer; other tests cover the start in a new interpreter.
"""

import asyncio
import multiprocessing
import os
import random
import sys
from collections.abc import Mapping
from io import TextIOWrapper
from multiprocessing.connection import Connection
from typing import Any

from tutorial.checks import exercise
from tutorial.checks.catalogue import exercises
from tutorial.checks.engine import child
from tutorial.checks.engine.diagnose import Diagnosis, Why
from tutorial.checks.engine.observe import Observations
from tutorial.checks.engine.twins import Twins

_server = multiprocessing.get_context("forkserver")
_server.set_forkserver_preload([child.__name__, *{each.module for those in exercises().values() for each in those}])


class Process:
    """The parts of asyncio's process that `tutorial.checks.engine.contain` uses; `start` replaces its own."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        pipes = [os.pipe() for _ in range(3)]
        (stdin, job), (told, stdout), (printed, stderr) = pipes
        given = [Connection(fd) for fd in (stdin, stdout, stderr)]
        self._process = _server.Process(target=_judge, args=(environment, *given))
        self._process.start()
        self.pid = self._process.pid
        for each in given:
            each.close()
        self.stdin = os.fdopen(job, "wb", buffering=0)
        self.ends = [os.fdopen(end, "rb", buffering=0) for end in (told, printed)]

    @property
    def returncode(self) -> int | None:
        """The exit status."""
        return self._process.exitcode

    async def wait(self) -> None:
        """Wait until it has ended."""
        self.stdin.close()
        await asyncio.to_thread(self._process.join)


async def start(environment: Mapping[str, str]) -> Process:
    """Fork a process that judges."""
    process = Process(environment)
    process.stdout, process.stderr = [await _reader(end) for end in process.ends]
    return process


async def _reader(pipe: Any) -> asyncio.StreamReader:
    reader = asyncio.StreamReader()
    await asyncio.get_running_loop().connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), pipe)
    return reader


def _judge(environment: Mapping[str, str], *given: Connection) -> None:
    """Set up the child like a newly started process, and run the program, which ends it."""
    os.setsid()  # because the parent kills the whole session
    for at, each in enumerate(given):
        os.dup2(each.fileno(), at)
        each.close()
    sys.stdout, sys.stderr = (TextIOWrapper(open(at, "wb", 0), "utf-8", write_through=True) for at in (1, 2))  # noqa: SIM115, PTH123
    os.environ.clear()
    os.environ.update(environment)
    random.seed()
    exercise.diagnose = _without_a_cause  # only the verdict matters, not the cause
    child.main()


def _without_a_cause(seen: Observations, _twins: Twins) -> Diagnosis:
    return Diagnosis({each.case.label: Why.MEANING for each in seen.odd[:1]})
