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
import threading
from collections import ChainMap
from collections.abc import AsyncIterator, Iterator
from typing import Any

import cloudpickle  # type: ignore[import-untyped, unused-ignore]
import msgspec

from tutorial.checks._verdict import Finding, Place, wrong
from tutorial.checks._watch import files_of
from tutorial.handoff import Latest
from tutorial.paths import PACKAGE

__all__ = ["Job", "contain"]

LIMIT = 120.0  # [s] of a whole check, whose watchdog ends what takes long far earlier
LONGEST_LINE = 1 << 20  # bytes
OUTPUT_KEPT = 20_000  # bytes
REST = 1.0  # [s] in which what was printed is read to its end, if something that was started still has the pipe
CLINGS = "The answer is run in a process of its own: let it take what it needs from config, io or its arguments."
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
    path = [os.path.abspath(entry) for entry in sys.path]  # noqa: PTH100
    process = _Process(Job(module, name, path, pickled, sorted(files_of(answer))))
    with process:
        await process.listen()
    return process.result(), tuple(process.output.decode(errors="replace").splitlines())


class _Process:
    """A process that judges one answer; it does not outlive this one.

    Attributes:
        output: what the learner's code has printed.
    """

    def __init__(self, job: Job) -> None:
        self.output = bytearray()
        self._job = job
        self._findings: list[Finding] = []
        self._trace = ""  # what Python itself has said when it died
        self._done = False
        report, theirs = os.pipe()
        home = os.pathsep.join(filter(None, (str(PACKAGE.parent), os.environ.get("PYTHONPATH"))))
        self._report = os.fdopen(report, "rb", buffering=0)
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-u", "-m", "tutorial.checks._child", str(theirs)],
            stdin=subprocess.PIPE,  # its end tells the process that this one is gone
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            bufsize=0,
            pass_fds=[theirs],
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": home, "PYTHONUTF8": "1"},
        )
        os.close(theirs)

    def __enter__(self) -> _Process:
        return self

    def __exit__(self, *_: object) -> None:
        with self._process:  # to leave it closes its streams, and waits for it
            self._report.close()
            self._kill()

    async def listen(self) -> None:
        """Give the process its job, and take in what it says until it is done, or ended."""
        assert self._process.stdin is not None
        with contextlib.suppress(TimeoutError, BrokenPipeError):
            async with asyncio.timeout(LIMIT), _reader(self._report) as told, _reader(self._process.stdout) as printed:
                keeping = asyncio.create_task(self._keep(printed))
                job = msgspec.json.encode(self._job)
                await asyncio.to_thread(self._process.stdin.write, len(job).to_bytes(8) + job)
                async for line in told:
                    self._take(line.decode(errors="replace").strip())
                self._kill()
                await asyncio.wait([keeping], timeout=REST)

    def result(self) -> tuple[Finding, ...]:
        """Return what was found; if the process came to a bad end, that is the last of it."""
        return (*self._findings, *(() if self._done else (self._bad_end(),)))

    def _take(self, line: str) -> None:
        if line == "done":
            self._done = True
            self._kill()
        else:
            try:
                self._findings.append(msgspec.json.decode(line, type=Finding))
            except msgspec.DecodeError:
                self._trace += f"{line}\n"

    async def _keep(self, printed: asyncio.StreamReader) -> None:
        while piece := await printed.read(OUTPUT_KEPT):
            self.output += piece[: OUTPUT_KEPT - len(self.output)]

    def _kill(self) -> None:
        """End the process, and what it may have started."""
        with contextlib.suppress(ProcessLookupError, PermissionError):  # the latter is what macOS says of a zombie
            os.killpg(self._process.pid, signal.SIGKILL)

    def _bad_end(self) -> Finding:
        status = self._process.returncode
        frames = _FRAME.findall(self._trace)
        place = next((Place(file, int(line), name) for file, line, name in frames if file in self._job.files), None)
        if "Timeout (" in self._trace:
            text, cause = "Python itself has come to a halt", "A call into C did not return, and let nothing else run."
        elif status >= 0:
            text = f"the process was ended, with exit status {status}"
            cause = "Most likely something in it ended the whole process, as os._exit does: a controller only returns."
        else:
            text = f"the process was ended by the signal {signal.Signals(-status).name}"
            cause = "Most likely something outside of Python went wrong, such as a library that was used wrongly."
        return wrong(text, cause, place)


@contextlib.asynccontextmanager
async def _reader(pipe: Any) -> AsyncIterator[asyncio.StreamReader]:
    reader = asyncio.StreamReader(LONGEST_LINE)
    protocol = asyncio.StreamReaderProtocol(reader)
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(lambda: protocol, pipe)
    try:
        yield reader
    finally:
        transport.close()


def _clinging(answer: Any, error: Exception) -> Finding:
    """Say which name refers to something that cannot leave the notebook's process."""
    for name, value in _used(answer):
        if value is not answer and not _is_portable(value):
            kind = type(value).__name__
            text = f"{answer.__name__} uses {name}, an object of the class {kind}, that belongs to the notebook"
            return wrong(text, CLINGS)
    return wrong(f"the answer cannot be run in a process of its own: {error}", CLINGS)


def _used(answer: Any) -> Iterator[tuple[str, Any]]:
    """Yield what an answer keeps, and the names from outside that its functions use, with what they refer to."""
    members = vars(answer) if isinstance(answer, type) else {answer.__name__: answer}
    for name, value in members.items():
        if inspect.isfunction(value):
            yield from inspect.getclosurevars(value).nonlocals.items()
            yield from ((each, value.__globals__.get(each)) for each in _names(value.__code__))
        elif not name.startswith("__"):
            yield name, value


def _names(code: Any) -> list[str]:
    """Collect the names in a function's code, and in that of the functions within."""
    inner = [name for each in code.co_consts if hasattr(each, "co_names") for name in _names(each)]
    return [*code.co_names, *inner]


def _pickled(value: Any) -> bytes:
    with io.BytesIO() as file:
        _Pickler(file).dump(value)
        return file.getvalue()


def _is_portable(value: Any) -> bool:
    try:
        _pickled(value)
    except Exception:  # noqa: BLE001 - pickling runs code of all kinds of objects
        return False
    return True
