"""Starts a command that ends when its parent does, even if the parent is killed: ``python parent_watch.py COMMAND...``.

This process watches standard input: when the other end closes because the parent has ended, this process asks the
command to stop, and kills it if it keeps running. The command and this process form one process group, so a signal to
the group reaches both. The command itself handles the signals that ask it to stop.

This file imports only the standard library and is run by its path, so it starts quickly.
"""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

TIMEOUT = 5.0  # [s] between asking the command to stop and killing it
STOP_SIGNALS = {signal.SIGINT, signal.SIGTERM}
OWN = str(Path(sys.executable).with_name("tank"))


def main() -> int:
    """Run the command, and return its exit status, or 128 + n if signal n ended the command."""
    command = sys.argv[1:]
    signal.pthread_sigmask(signal.SIG_BLOCK, STOP_SIGNALS)
    early: set[int] = set()
    os.register_at_fork(before=lambda: early.update(signal.sigpending() & STOP_SIGNALS))
    try:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, preexec_fn=partial(_begin, command[0], early))  # noqa: PLW1509
    except OSError as error:
        print(f"{command[0]} could not be started: {error.strerror}", file=sys.stderr)  # noqa: T201
        return 127
    for number in STOP_SIGNALS:
        signal.signal(number, lambda *_: None)  # the command also receives the signal
    signal.pthread_sigmask(signal.SIG_UNBLOCK, STOP_SIGNALS)
    threading.Thread(target=_watch, args=(process,), daemon=True).start()
    status = process.wait()
    return status if status >= 0 else 128 - status


def start_watched(
    words: Sequence[str], environment: Mapping[str, str], folder: str | Path | None = None
) -> subprocess.Popen[str]:
    """Start a command that ends when this process does. Its stdout is text, and includes its stderr.

    Args:
        words: the command and its arguments.
        environment: its environment variables.
        folder: its working directory; None for the current directory.

    Raises:
        OSError, TypeError, ValueError: the command cannot be started with these arguments.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, STOP_SIGNALS)  # the child inherits this mask, and resets it
    try:
        return subprocess.Popen(
            [sys.executable, "-S", "-I", __file__, *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env={"PYTHONUNBUFFERED": "1", **environment},
            cwd=folder,
            encoding="utf-8",
            errors="replace",
        )
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def signal_group(pid: int, number: int) -> bool:
    """Send a signal to a watched command and all its child processes; signal 0 only checks whether they exist.

    Returns:
        Whether any of these processes still exists.
    """
    try:
        os.killpg(pid, number)
    except (ProcessLookupError, PermissionError):  # macOS raises PermissionError for a zombie
        return False
    return True


def _begin(program: str, early: set[int]) -> None:
    """Restore the default signal handling, and forward to the command any signals that arrived before it was started.

    A ``tank`` command unblocks SIGINT itself when it is ready. Before that, Python would respond with a traceback.
    """
    for each in STOP_SIGNALS:
        signal.signal(each, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM} if program == OWN else STOP_SIGNALS)
    for number in early:
        os.kill(os.getpid(), number)


def _watch(process: subprocess.Popen[bytes]) -> None:
    """Wait until the other end of stdin is closed, then end the process group."""
    os.read(0, 1)
    os.killpg(0, signal.SIGINT)
    try:
        process.wait(TIMEOUT)
    finally:
        os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    sys.exit(main())
