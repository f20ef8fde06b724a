"""Starts commands that end when their parent does, even when that is killed: ``python parent_watch.py COMMAND...``.

Standard input is the watch: when its other end is closed, because the parent has gone, this process asks the command to
stop, and kills it if it doesn't. The command and this process are one process group, which can be signalled as a whole.
Signals that ask are left to the command.

Standard library only, and run by its path: starting it costs next to nothing.
"""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

PATIENCE = 5.0  # [s] from asking to killing
ASKING = {signal.SIGINT, signal.SIGTERM}
OWN = str(Path(sys.executable).with_name("tank"))


def main() -> int:
    """Run the command, and return its exit status; 128 + n where signal n ended it."""
    command = sys.argv[1:]
    signal.pthread_sigmask(signal.SIG_BLOCK, ASKING)
    early: set[int] = set()
    os.register_at_fork(before=lambda: early.update(signal.sigpending() & ASKING))
    try:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, preexec_fn=partial(_begin, command[0], early))  # noqa: PLW1509
    except OSError as error:
        print(f"{command[0]} could not be started: {error.strerror}", file=sys.stderr)  # noqa: T201
        return 127
    for asking in ASKING:
        signal.signal(asking, lambda *_: None)  # the command has it, too
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ASKING)
    threading.Thread(target=_watch, args=(process,), daemon=True).start()
    status = process.wait()
    return status if status >= 0 else 128 - status


def start_watched(
    words: Sequence[str], environment: Mapping[str, str], folder: str | Path | None = None
) -> subprocess.Popen[str]:
    """Start a command that ends when this process does. What it prints, errors too, are lines of text from its stdout.

    Args:
        words: the command and its arguments.
        environment: its variables.
        folder: where it works; None for the current directory.

    Raises:
        OSError, TypeError, ValueError: it cannot be started so.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ASKING)  # a child has this, too, and is quiet until it is ready
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
    """Signal a watched command, with all that comes from it; 0 asks nothing of it.

    Returns:
        Whether there is something left of it.
    """
    try:
        os.killpg(pid, number)
    except (ProcessLookupError, PermissionError):  # PermissionError: what macOS says of a zombie
        return False
    return True


def _begin(program: str, early: set[int]) -> None:
    """Restore the command's signals, and send it those that came before it was started, each once.

    Of SIGINT, which Python tells with a traceback while it starts, ``tank`` itself says when it takes it.
    """
    for asking in ASKING:
        signal.signal(asking, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM} if program == OWN else ASKING)
    for number in early:
        os.kill(os.getpid(), number)


def _watch(process: subprocess.Popen[bytes]) -> None:
    """Wait until the other end of stdin is closed, then end the group."""
    os.read(0, 1)
    os.killpg(0, signal.SIGINT)
    try:
        process.wait(PATIENCE)
    finally:
        os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    sys.exit(main())
