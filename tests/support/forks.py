"""Answers judged in forks of one process that has imported all it takes, instead of in an interpreter of their own.

For mutants, of which there are hundreds: to be judged takes each of them a third of the time. What it is run with is
otherwise what a learner's answer is run with; that it begins in a fresh interpreter is for other tests.
"""

from __future__ import annotations

import atexit
import gc
import json
import os
import random
import socket
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from io import TextIOWrapper
from typing import Any, NoReturn

PIPE, STDOUT = subprocess.PIPE, subprocess.STDOUT
PART = 65536  # bytes


class Popen:
    """As much of `subprocess.Popen` as `tutorial.checks._contain` asks for; this module stands in for `subprocess`.

    Args:
        command: of which the last words are the numbers of descriptors.
        pass_fds: those.
        env: the environment.
    """

    def __init__(self, command: Sequence[str], *, pass_fds: Sequence[int], env: dict[str, str], **_: Any) -> None:
        stdin, self._stdin = os.pipe()
        out, stdout = os.pipe()
        socket.send_fds(_parent(), [_line({"env": env})], [stdin, stdout, *pass_fds])
        self.pid = int(_parent().recv(PART))
        for fd in (stdin, stdout):
            os.close(fd)
        self.stdout = os.fdopen(out, "rb", buffering=0)
        self.returncode: int | None = None

    def __enter__(self) -> Popen:
        return self

    def __exit__(self, *_: object) -> None:
        """Close the streams, and wait for the end."""
        os.close(self._stdin)
        self.stdout.close()
        _parent().sendall(_line({"wait": self.pid}))
        self.returncode = os.waitstatus_to_exitcode(int(_parent().recv(PART)))


def _line(request: dict[str, Any]) -> bytes:
    return json.dumps(request).encode() + b"\n"


@cache
def _parent() -> socket.socket:
    """Start the process that forks, which ends with this one; return what it is asked through."""
    ours, its = socket.socketpair()
    with its:
        process = subprocess.Popen([sys.executable, __file__, str(its.fileno())], pass_fds=[its.fileno()])

    def end() -> None:
        ours.close()
        process.wait()

    atexit.register(end)
    return ours


def main() -> None:
    """Fork whenever this is asked for, and wait for whom it is told to."""
    asked = socket.socket(fileno=int(sys.argv[1]))
    from tutorial.checks import _child
    from tutorial.checks.catalogue import exercises

    exercises()  # which imports them all
    gc.freeze()
    while True:
        request, fds, _, _ = socket.recv_fds(asked, PART, 8)
        while not request.endswith(b"\n"):
            part = asked.recv(PART)
            if not part:
                return
            request += part
        what = json.loads(request)
        if "wait" in what:
            asked.send(str(os.waitpid(what["wait"], 0)[1]).encode())
        elif os.fork() == 0:
            _judge(_child.main, asked, what["env"], fds)
        for fd in fds:
            os.close(fd)


def _judge(program: Any, asked: socket.socket, environment: dict[str, str], fds: Sequence[int]) -> NoReturn:
    """Be what a process is in the beginning that was started for it, and run the program, which ends it."""
    os.setsid()
    asked.send(str(os.getpid()).encode())  # not before: it is the whole session that will be killed
    asked.close()
    stdin, stdout, *passed = fds
    for fd, at in ((stdin, 0), (stdout, 1), (stdout, 2)):
        os.dup2(fd, at)
    os.close(stdin)
    os.close(stdout)
    sys.stdout, sys.stderr = (TextIOWrapper(open(at, "wb", 0), "utf-8", write_through=True) for at in (1, 2))  # noqa: SIM115, PTH123
    os.environ.clear()
    os.environ.update(environment)
    random.seed()
    sys.argv[1:] = map(str, passed)
    program()


if __name__ == "__main__":
    main()
