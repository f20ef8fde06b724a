"""Running an answer in a process of its own, so that whatever it does ends with that process."""

from __future__ import annotations

import asyncio
import contextlib
import inspect
import io
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
from collections import ChainMap
from collections.abc import Iterable, Iterator
from typing import Any

import cloudpickle  # type: ignore[import-untyped, unused-ignore]
import msgspec

from tutorial.checks._verdict import Finding, Place, wrong
from tutorial.checks._watch import files_of
from tutorial.handoff import Latest
from tutorial.paths import PACKAGE

__all__ = ["Job", "contain"]

SILENCE = 60.0  # [s] without a sign of life from the process, which gives one ten times a second
OUTPUT_KEPT = 100  # lines
CHUNK = 65536
_FRAME = re.compile(r'File "(.+)", line (\d+) in (\S+)')


class Job(msgspec.Struct):
    """What the process is to do.

    Attributes:
        module, name: where the exercise is.
        path: where modules are looked for.
        answer: the answer, pickled by value.
        files: where the learner's code is.
    """

    module: str
    name: str
    path: list[str]
    answer: bytes
    files: list[str]


class _Pickler(cloudpickle.Pickler):  # type: ignore[misc, unused-ignore]
    """Takes what is made of locks along, too: at the other end they are new, and free."""

    dispatch_table = ChainMap(
        {
            type(threading.Lock()): lambda _: (threading.Lock, ()),
            type(threading.RLock()): lambda _: (threading.RLock, ()),
            Latest: lambda latest: (Latest, (latest.get(),)),
        },
        cloudpickle.Pickler.dispatch_table,
    )


async def contain(module: str, name: str, answer: Any) -> tuple[tuple[Finding, ...], tuple[str, ...]]:
    """Have an answer judged in a process of its own, while the loop goes on with whatever else there is.

    Args:
        module: where the exercise is.
        name: what it is called there.
        answer: the learner's class or function.

    Returns:
        What was found, and the lines that the learner's code has printed.
    """
    try:
        pickled = _pickled(answer)
    except Exception as error:  # noqa: BLE001 - pickling runs code of all kinds of objects
        return (_clinging(answer, error),), ()
    job = Job(module, name, [os.path.abspath(entry) for entry in sys.path], pickled, sorted(files_of(answer)))  # noqa: PTH100
    with _Process(job) as process:
        await process.listen()
    return process.result(), tuple(process.output)


class _Process:
    """A process that judges one answer; it does not outlive this one."""

    def __init__(self, job: Job) -> None:
        self._report, report = os.pipe()
        home = os.pathsep.join(filter(None, (str(PACKAGE.parent), os.environ.get("PYTHONPATH"))))
        self._files = set(job.files)
        self._findings: list[Finding] = []
        self._trace = ""
        self._trace_file = tempfile.TemporaryFile()  # noqa: SIM115 - closed when ``with`` ends
        self._done = False
        self.output: list[str] = []
        with tempfile.TemporaryFile() as file:  # a pipe would hold only so much, and whoever writes has to wait
            file.write(msgspec.json.encode(job))
            file.seek(0)
            fds = [report, file.fileno(), self._trace_file.fileno()]
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-u", "-m", "tutorial.checks._child", *map(str, fds)],
                stdin=subprocess.PIPE,  # its end tells the process that this one is gone
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                pass_fds=fds,
                start_new_session=True,
                env={**os.environ, "PYTHONPATH": home, "PYTHONUTF8": "1"},
            )
        os.close(report)

    def __enter__(self) -> _Process:
        return self

    def __exit__(self, *_: object) -> None:
        """End the process, and what it may have started."""
        gone = (ProcessLookupError, PermissionError)  # PermissionError: what macOS says of a zombie
        with self._process, contextlib.suppress(*gone):  # to leave it closes its streams, and waits for it
            os.killpg(self._process.pid, signal.SIGKILL)
        os.close(self._report)
        with self._trace_file as file:
            file.seek(0)
            self._trace = file.read().decode(errors="replace")

    async def listen(self) -> None:
        """Take in what the process says until it is done, or ended, or gone silent."""
        assert self._process.stdout is not None
        said, printed = _Lines(), _Lines()
        sources = {self._report: said, self._process.stdout.fileno(): printed}
        while not self._done and self._report in sources:
            fd = await _readable(sources)
            if fd is None:
                return
            if not sources[fd].read(fd):
                del sources[fd]
            self._take(said.taken())
            self.output += printed.taken()[: OUTPUT_KEPT - len(self.output)]
        os.set_blocking(self._process.stdout.fileno(), False)
        printed.read_all(self._process.stdout.fileno())
        self.output += printed.taken(rest=True)[: OUTPUT_KEPT - len(self.output)]

    def result(self) -> tuple[Finding, ...]:
        """Return what was found; if the process came to a bad end, that is the last of it."""
        return (*self._findings, *(() if self._done else (self._bad_end(),)))

    def _take(self, lines: list[str]) -> None:
        for line in lines:
            if line == "done":
                self._done = True
            elif line:
                self._findings.append(msgspec.json.decode(line, type=Finding))

    def _bad_end(self) -> Finding:
        status = self._process.returncode
        frames = _FRAME.findall(self._trace)
        place = next((Place(file, int(line), name) for file, line, name in frames if file in self._files), None)
        if self._trace.startswith("Timeout"):
            text, cause = "Python itself has come to a halt", "A call into C did not return, and let nothing else run."
        elif status >= 0:
            text = f"the process was ended, with exit status {status}"
            cause = "Most likely something in it ended the whole process, as os._exit does: a controller only returns."
        else:
            text = f"the process was ended by the signal {signal.Signals(-status).name}"
            cause = "Most likely something outside of Python went wrong, such as a library that was used wrongly."
        return wrong(text, cause, place)


async def _readable(fds: Iterable[int]) -> int | None:
    """Wait until there is something to read from one of them; None if there is nothing for too long."""
    loop = asyncio.get_running_loop()
    ready: asyncio.Queue[int] = asyncio.Queue()
    for fd in fds:
        loop.add_reader(fd, ready.put_nowait, fd)
    try:
        async with asyncio.timeout(SILENCE):  # wait_for loses an interrupt that comes together with something to read
            return await ready.get()
    except TimeoutError:
        return None
    finally:
        for fd in fds:
            loop.remove_reader(fd)


class _Lines:
    """Text that comes in pieces, cut into lines; what nobody will read is not kept."""

    def __init__(self) -> None:
        self._waiting = b""

    def read(self, fd: int) -> bool:
        """Take in a piece; False at the end."""
        piece = os.read(fd, CHUNK)
        self._waiting += piece
        return bool(piece)

    def read_all(self, fd: int) -> None:
        """Take in what is there, but not for ever."""
        with contextlib.suppress(BlockingIOError):
            for _ in range(OUTPUT_KEPT):
                if not self.read(fd):
                    return

    def taken(self, rest: bool = False) -> list[str]:
        """Hand out the lines that are complete, or all."""
        *lines, self._waiting = self._waiting.split(b"\n")
        if (rest and self._waiting) or len(self._waiting) > CHUNK:
            lines.append(self._waiting)
            self._waiting = b""
        return [line.decode(errors="replace") for line in lines]


def _clinging(answer: Any, error: Exception) -> Finding:
    """Say which name refers to something that cannot leave the notebook's process."""
    cause = "The answer is run in a process of its own: let it take what it needs from config, io or its arguments."
    members = [answer, *vars(answer).values()] if isinstance(answer, type) else [answer]
    for function in (member for member in members if inspect.isfunction(member)):
        for name, value in _used(function):
            if value is not answer and not _portable(value):
                kind = type(value).__name__
                text = f"{function.__name__} uses {name}, an object of the class {kind}, that belongs to the notebook"
                return wrong(text, cause)
    for name, value in vars(answer).items():
        if not name.startswith("__") and not inspect.isroutine(value) and not _portable(value):
            kind = type(value).__name__
            return wrong(f"the class keeps {name}, an object of the class {kind}, that belongs to the notebook", cause)
    return wrong(f"the answer cannot be run in a process of its own: {error}", cause)


def _used(function: Any) -> Iterator[tuple[str, Any]]:
    """Yield the names from outside that a function uses, with what they refer to."""
    for name in _names(function.__code__):
        if name in function.__globals__:
            yield name, function.__globals__[name]
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or ()):
        if name != "__class__":
            with contextlib.suppress(ValueError):  # not filled yet
                yield name, cell.cell_contents


def _names(code: Any) -> list[str]:
    """Collect the names in a function's code, and in that of the functions within."""
    inner = [name for each in code.co_consts if hasattr(each, "co_names") for name in _names(each)]
    return [*code.co_names, *inner]


def _pickled(value: Any) -> bytes:
    with io.BytesIO() as file:
        _Pickler(file).dump(value)
        return file.getvalue()


def _portable(value: Any) -> bool:
    try:
        _pickled(value)
    except Exception:  # noqa: BLE001 - pickling runs code of all kinds of objects
        return False
    return True
