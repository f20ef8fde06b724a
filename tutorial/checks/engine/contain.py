"""Containment: an answer runs in a separate process, so that nothing it starts outlives that process."""

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

from tutorial.checks.engine.answer import files_of
from tutorial.checks.engine.shared_state import outside, pickled
from tutorial.checks.engine.verdict import Finding, Place, wrong
from tutorial.ros.domains import reserved_domain
from tutorial.system.parent_watch import signal_group
from tutorial.system.paths import PACKAGE

DONE = b"done\n"
LIMIT = 120.0  # [s] time limit for a whole check; the watchdog usually stops a slow answer much earlier
OUTPUT_KEPT = 20_000  # bytes
REST = 1.0  # [s] time limit for reading the remaining output: a process that the answer started may hold the pipe open
CLINGS = "The answer runs in a separate process. It must get everything that it needs from config, io or its arguments."
OWN_LOOP = "The answer runs in a process with its own event loop: write asyncio.get_running_loop() instead."
_FRAME = re.compile(r'File "(.+)", line (\d+) in (\S+)')


async def contain(module: str, name: str, answer: Any) -> tuple[tuple[Finding, ...], tuple[str, ...]]:
    """Judge an answer in a separate process, while the event loop keeps running.

    Args:
        module: the exercise's module.
        name: the exercise's name in that module.
        answer: the learner's class or function.

    Returns:
        The findings, and the lines that the learner's code printed.

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
    """Run the process until it exits. Return the reported lines, the learner's output, and the exit status."""
    home = os.pathsep.join(filter(None, (str(PACKAGE.parent), os.environ.get("PYTHONPATH"))))
    kept = {name: value for name, value in os.environ.items() if name != "ROS_STATIC_PEERS"}
    ros = {"ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    # The process draws nothing, so MuJoCo can skip its slow search for OpenGL.
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
    """Start the process. It reports the findings on stdout; the output of the learner's code goes to stderr."""
    command = sys.executable, "-P", "-u", "-m", "tutorial.checks.engine.child"
    return await asyncio.create_subprocess_exec(
        *command, stdin=PIPE, stdout=PIPE, stderr=PIPE, start_new_session=True, env=environment
    )


async def _keep(printed: Any, output: bytearray) -> None:
    """Read all output, but store only its beginning."""
    while piece := await printed.read(OUTPUT_KEPT):
        output += piece[: OUTPUT_KEPT - len(output)]


def _findings(told: Sequence[bytes], files: Collection[str], status: int | None) -> tuple[Finding, ...]:
    """Return the findings. If the process crashed or was killed, the last finding reports this.

    Args:
        told: the lines that the process reported.
        files: the files that contain the learner's code.
        status: the exit status.
    """
    findings = [msgspec.json.decode(line, type=Finding) for line in told if line.startswith(b"{")]
    if DONE not in told:  # the process ended early; its other lines are a Python traceback
        findings.append(_bad_end(b"".join(told).decode(errors="replace"), files, status or 0))
    return tuple(findings)


def _bad_end(trace: str, files: Collection[str], status: int) -> Finding:
    frames = _FRAME.findall(trace)
    place = next((Place(file, int(line), name) for file, line, name in frames if file in files), None)
    if "Timeout (" in trace:
        text, cause = "Python itself hangs", "A call into C code probably did not return, and blocked all threads."
    elif status >= 0:
        text = f"the process exited with status {status}"
        cause = "Your code probably exits the whole process, as os._exit does. A method only has to return."
    else:
        text = f"the process was killed by the signal {signal.Signals(-status).name}"
        cause = "Code outside Python probably crashed, for example after an incorrect call into a C library."
    return wrong(text, cause, place)


def _clinging(answer: Any, error: Exception) -> Finding:
    """Return a finding that names the object that cannot be pickled."""
    for name, value in outside(answer):
        try:
            pickled(None if value is answer else value)
        except Exception:  # noqa: BLE001 - pickling runs code of all kinds of objects
            own, kind = name.rpartition(".")[2], type(value).__name__
            text = f"{answer.__name__} uses {own}, an object of the class {kind} that belongs to the notebook"
            return wrong(text, OWN_LOOP if isinstance(value, asyncio.AbstractEventLoop) else CLINGS)
    return wrong(f"the answer cannot run in a separate process: {error}", CLINGS)
