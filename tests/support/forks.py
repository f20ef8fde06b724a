"""Answers judged in forks of one process that has imported all it takes, instead of in an interpreter of their own.

For mutants, of which there are hundreds: to be judged takes each of them a third of the time. What it is run with is
otherwise what a learner's answer is run with; that it begins in a fresh interpreter is for other tests.
"""

from __future__ import annotations

import multiprocessing
import os
import random
import subprocess
import sys
from collections.abc import Sequence
from io import TextIOWrapper
from multiprocessing.connection import Connection
from typing import Any

from tutorial.checks import _child
from tutorial.checks.catalogue import exercises

PIPE, STDOUT = subprocess.PIPE, subprocess.STDOUT

_server = multiprocessing.get_context("forkserver")
_server.set_forkserver_preload([_child.__name__, *{each.module for those in exercises().values() for each in those}])


class Popen:
    """As much of `subprocess.Popen` as `tutorial.checks._contain` asks for; this module stands in for `subprocess`.

    Args:
        command: of which only its program's is run, whatever it says.
        pass_fds: the descriptors that the program is given.
        env: the environment.
    """

    def __init__(self, command: Sequence[str], *, pass_fds: Sequence[int], env: dict[str, str], **_: Any) -> None:
        stdin, job = os.pipe()
        out, stdout = os.pipe()
        given = [Connection(fd) for fd in (stdin, stdout, *map(os.dup, pass_fds))]
        self._process = _server.Process(target=_judge, args=(env, *given))
        self._process.start()
        self.pid = self._process.pid
        for each in given:
            each.close()
        self.stdin, self.stdout = os.fdopen(job, "wb", buffering=0), os.fdopen(out, "rb", buffering=0)
        self.returncode: int | None = None

    def __enter__(self) -> Popen:
        return self

    def __exit__(self, *_: object) -> None:
        """Close the streams, and wait for the end."""
        self.stdin.close()
        self.stdout.close()
        self._process.join()
        self.returncode = self._process.exitcode


def _judge(environment: dict[str, str], stdin: Connection, stdout: Connection, *passed: Connection) -> None:
    """Be what a process is in the beginning that was started for it, and run the program, which ends it."""
    os.setsid()  # it is the whole session that will be killed
    for given, at in ((stdin, 0), (stdout, 1), (stdout, 2)):
        os.dup2(given.fileno(), at)
    stdin.close()
    stdout.close()
    sys.stdout, sys.stderr = (TextIOWrapper(open(at, "wb", 0), "utf-8", write_through=True) for at in (1, 2))  # noqa: SIM115, PTH123
    os.environ.clear()
    os.environ.update(environment)
    random.seed()
    sys.argv[1:] = [str(each.fileno()) for each in passed]
    _child.main()
