"""Running an answer in a process of its own, so that whatever it does ends with that process."""

import asyncio
import contextlib
import os
import pickle
import re
import signal
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import msgspec

from tutorial.checks._shared import outside, pickled
from tutorial.checks._verdict import Finding, Place, wrong
from tutorial.checks._watch import files_of
from tutorial.parent_watch import signal_group
from tutorial.paths import PACKAGE
from tutorial.ros.domains import reserved_domain

DONE = b"done\n"
LIMIT = 120.0  # [s] of a whole check, whose watchdog ends what takes long far earlier
OUTPUT_KEPT = 20_000  # bytes
REST = 1.0  # [s] in which what was printed is read to its end, if something that was started still has the pipe
CLINGS = "The answer is run in a process of its own: let it take what it needs from config, io or its arguments."
_FRAME = re.compile(r'File "(.+)", line (\d+) in (\S+)')


async def contain(module: str, name: str, answer: Any) -> tuple[tuple[Finding, ...], tuple[str, ...]]:
    """Have an answer judged in a process of its own, while the loop goes on with whatever else there is.

    Args:
        module: where the exercise is.
        name: what it is called there.
        answer: the learner's class or function.

    Returns:
        What was found, and the lines that the learner's code has printed.

    Raises:
        TutorialError: no ROS domain is free.
    """
    path = [os.path.abspath(entry) for entry in sys.path]  # noqa: PTH100
    try:
        job = pickle.dumps((module, name, path, pickled(answer)))
    except Exception as error:  # noqa: BLE001 - pickling runs code of all kinds of objects
        return (_clinging(answer, error),), ()
    with reserved_domain(avoid=os.environ.get("ROS_DOMAIN_ID")) as domain:
        told, output, status = await _run(job, domain)
    return _findings(told, files_of(answer), status), tuple(output.decode(errors="replace").splitlines())


async def _run(job: bytes, domain: int) -> tuple[list[bytes], bytearray, int | None]:
    """Run the process to its end. Returns the lines that it has told, what was printed, and the exit status."""
    home = os.pathsep.join(filter(None, (str(PACKAGE.parent), os.environ.get("PYTHONPATH"))))
    kept = {name: value for name, value in os.environ.items() if name != "ROS_STATIC_PEERS"}
    ros = {"ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    # Nothing is drawn there, so MuJoCo need not look for OpenGL, which takes long.
    process = await _start({**kept, **ros, "PYTHONPATH": home, "PYTHONUTF8": "1", "MUJOCO_GL": "disable"})
    assert process.stdin is not None
    assert process.stdout is not None
    told, output = list[bytes](), bytearray()
    printing = asyncio.create_task(_keep(process.stderr, output))
    try:
        process.stdin.write(job)
        async with asyncio.timeout(LIMIT):
            async for line in process.stdout:
                told.append(line)
                if line == DONE:
                    break
    except TimeoutError:
        pass
    finally:
        signal_group(process.pid, signal.SIGKILL)
        await process.wait()
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(printing, REST)
    return told, output, process.returncode


async def _start(environment: Mapping[str, str]) -> Process:
    """Start the process. Its stdout is for what is found; what the learner's code prints comes by stderr."""
    command = sys.executable, "-P", "-u", "-m", "tutorial.checks._child"
    return await asyncio.create_subprocess_exec(
        *command, stdin=PIPE, stdout=PIPE, stderr=PIPE, start_new_session=True, env=environment
    )


async def _keep(printed: Any, output: bytearray) -> None:
    """Read what is printed, and keep the beginning."""
    while piece := await printed.read(OUTPUT_KEPT):
        output += piece[: OUTPUT_KEPT - len(output)]


def _findings(told: Sequence[bytes], files: Collection[str], status: int | None) -> tuple[Finding, ...]:
    """Return what was found; if the process came to a bad end, that is the last of it.

    Args:
        told: the lines that it has told.
        files: where the learner's code is.
        status: of its end.
    """
    findings = [msgspec.json.decode(line, type=Finding) for line in told if line.startswith(b"{")]
    if DONE not in told:  # other lines are what Python itself has said when it died
        findings.append(_bad_end(b"".join(told).decode(errors="replace"), files, status or 0))
    return tuple(findings)


def _bad_end(trace: str, files: Collection[str], status: int) -> Finding:
    frames = _FRAME.findall(trace)
    place = next((Place(file, int(line), name) for file, line, name in frames if file in files), None)
    if "Timeout (" in trace:
        text, cause = "Python itself has come to a halt", "A call into C did not return, and let nothing else run."
    elif status >= 0:
        text = f"the process was ended, with exit status {status}"
        cause = "Most likely something in it ended the whole process, as os._exit does: a controller only returns."
    else:
        text = f"the process was ended by the signal {signal.Signals(-status).name}"
        cause = "Most likely something outside of Python went wrong, such as a library that was used wrongly."
    return wrong(text, cause, place)


def _clinging(answer: Any, error: Exception) -> Finding:
    """Say which name refers to something that cannot leave the notebook's process."""
    for name, value in outside(answer):
        try:
            pickled(None if value is answer else value)
        except Exception:  # noqa: BLE001 - pickling runs code of all kinds of objects
            own, kind = name.rpartition(".")[2], type(value).__name__
            text = f"{answer.__name__} uses {own}, an object of the class {kind}, that belongs to the notebook"
            return wrong(text, CLINGS)
    return wrong(f"the answer cannot be run in a process of its own: {error}", CLINGS)
