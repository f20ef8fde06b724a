"""What is open in this kernel, by name, and what the library has said meanwhile."""

import asyncio
import logging
import time
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

from tutorial.errors import TutorialError, printable_lines

PATIENCE = 30.0  # [s] that `until` waits: a classroom's server may be slow
LOOK_EVERY = 0.01  # [s] between two looks at a condition
LINES_KEPT = 100


class LogLines(logging.Handler):
    """Keeps what is logged. A line printed by another thread would appear below whichever cell was run last.

    Attributes:
        lines: the newest, each with its time, of `time.monotonic` [s]. Any thread may add one at any moment.
    """

    def __init__(self) -> None:
        super().__init__()
        self.lines: deque[tuple[float, str]] = deque(maxlen=LINES_KEPT)

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a line. Any thread."""
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
    """Make something and keep it under a name, after closing what was kept under it.

    Args:
        name: what it is called, for instance ``"program simulation"``.
        make: makes it.
        close: closes it.
    """
    _close(name)
    made = make()
    _open[name] = made, lambda: close(made)
    return made


def keep_once(name: str, make: Callable[[], T], close: Callable[[T], object]) -> T:
    """As `keep`, but what is kept already stays and is returned."""
    return _open[name][0] if name in _open else keep(name, make, close)


def close_all() -> None:
    """Close everything that is open in this kernel, the newest first. What was shown last stays on the page."""
    for name in reversed(tuple(_open)):
        try:
            _close(name)
        except Exception:  # noqa: BLE001 - whatever it is, the others still have to be closed
            _log.exception("%s could not be closed", name)


async def until(condition: Callable[[], object], what: str = "", patience: float = PATIENCE) -> None:
    """Wait until something is so; the kernel stays free meanwhile.

    Args:
        condition: called again and again, until what it returns counts as true.
        what: what is waited for, as the error should say it.
        patience: how long at most [s].

    Raises:
        TutorialError: it has not become so.
    """
    began = time.monotonic()
    while not condition():
        if time.monotonic() > began + patience:
            raise TutorialError(_in_vain(began, patience, what))
        await asyncio.sleep(LOOK_EVERY)


def _in_vain(began: float, patience: float, what: str) -> str:
    """Say what was waited for, and the newest error that was logged meanwhile: it may be the cause."""
    said = f"waited {patience:g} s in vain{f' for {what}' if what else ''}."
    errors = [line for time, line in logged.lines.copy() if time >= began and line.startswith("[ERROR]")]
    hint = f"Meanwhile: {errors[-1]}" if errors else "Run the cells above, in order, then this one."
    return f"{said} {hint}"


def log() -> None:
    """Print what the library has logged since this was last called. It comes from any thread, so no cell shows it."""
    for _ in range(len(logged.lines)):
        print(logged.lines.popleft()[1])  # noqa: T201 - what it is for


def _close(name: str) -> None:
    if name in _open:
        _, close = _open.pop(name)
        close()
