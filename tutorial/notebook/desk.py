"""The registry of the objects that are open in this kernel, and the library's newest log lines."""

import asyncio
import logging
import time
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

from tutorial.errors import TutorialError, printable_lines

TIMEOUT = 30.0  # [s] how long `until` waits at most: a classroom server can be slow
LOOK_EVERY = 0.01  # [s] between checks of a condition
LINES_KEPT = 100


class LogLines(logging.Handler):
    """Keeps log lines instead of printing them: other threads' output would appear below the cell that was run last.

    Attributes:
        lines: the newest lines, each with its `time.monotonic` timestamp [s]. Any thread can add lines at any time.
    """

    def __init__(self) -> None:
        super().__init__()
        self.lines: deque[tuple[float, str]] = deque(maxlen=LINES_KEPT)

    def emit(self, record: logging.LogRecord) -> None:
        """Format a log record as a line, and store the line. Thread-safe."""
        line = f"[{record.levelname}] {record.getMessage()}"
        if record.exc_info and record.exc_info[1] is not None:
            line += f": {type(record.exc_info[1]).__name__}: {record.exc_info[1]}"
        self.lines.append((time.monotonic(), printable_lines(line)))


T = TypeVar("T")

logged = LogLines()
"""The newest lines that the library has logged in this process."""

_log = logging.getLogger(__name__)
_open: dict[str, tuple[Any, Callable[[], object]]] = {}


def keep(name: str, make: Callable[[], T], close: Callable[[T], object]) -> T:
    """Make an object and register it under a name, after closing any object that already has this name.

    Args:
        name: the name, for instance ``"program simulation"``.
        make: makes the object.
        close: closes the object.
    """
    close_kept(name)
    made = make()
    _open[name] = made, lambda: close(made)
    return made


def keep_once(name: str, make: Callable[[], T], close: Callable[[T], object]) -> T:
    """Return the object registered under a name; if there is none, make and register an object as `keep` does."""
    return _open[name][0] if name in _open else keep(name, make, close)


def close_all() -> None:
    """Close everything that is open in this kernel, newest first. Widgets keep showing their last content."""
    for name in reversed(tuple(_open)):
        try:
            close_kept(name)
        except Exception:  # noqa: BLE001 - the remaining objects still have to be closed
            _log.exception("%s could not be closed", name)


async def until(condition: Callable[[], object], what: str = "", timeout: float = TIMEOUT) -> None:
    """Wait until a condition holds. The kernel stays responsive.

    Args:
        condition: called repeatedly until it returns a true value.
        what: a description of the condition, for the error message.
        timeout: the maximum time to wait [s].

    Raises:
        TutorialError: the condition did not hold in time.
    """
    began = time.monotonic()
    while not condition():
        if time.monotonic() > began + timeout:
            raise TutorialError(_in_vain(began, timeout, what))
        await asyncio.sleep(LOOK_EVERY)


def _in_vain(began: float, timeout: float, what: str) -> str:
    """Describe the timeout; include the last error logged during the wait, which may be the cause."""
    said = f"timed out after {timeout:g} s{f' waiting for {what}' if what else ''}."
    errors = [line for time, line in logged.lines.copy() if time >= began and line.startswith("[ERROR]")]
    hint = f"Meanwhile: {errors[-1]}" if errors else "Run the cells above, in order, then this one."
    return f"{said} {hint}"


def log() -> None:
    """Print the lines that the library has logged since the last call.

    Any thread can log, so log lines are not displayed in a cell automatically.
    """
    for _ in range(len(logged.lines)):
        print(logged.lines.popleft()[1])  # noqa: T201 - this function prints


def close_kept(name: str) -> None:
    """Close the object registered under a name, if there is one."""
    if name in _open:
        _, close = _open.pop(name)
        close()
