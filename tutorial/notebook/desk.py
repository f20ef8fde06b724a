"""What is open in this kernel, by name, and what the library has said meanwhile."""

from __future__ import annotations

import asyncio
import atexit
import logging
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from tutorial.errors import TutorialError

__all__ = ["close_all", "keep", "keep_once", "log", "until"]

PATIENCE = 30.0  # [s] that `until` waits: a classroom's server may be slow
LOOK_EVERY = 0.01  # [s] between two looks at a condition
LINES_KEPT = 100


class Closable(Protocol):
    """What can be left open."""

    def close(self) -> None:
        """Let it go. Idempotent."""


T = TypeVar("T", bound=Closable)

_open: dict[str, Closable] = {}


def keep(name: str, make: Callable[[], T]) -> T:
    """Make something and keep it under a name, after closing what was kept under it.

    Args:
        name: what it is called, for instance ``"the program simulation"``.
        make: makes it.
    """
    _close(name)
    made = make()
    _open[name] = made
    return made


def keep_once(name: str, make: Callable[[], T]) -> T:
    """As `keep`, but what is kept already stays and is returned."""
    kept: Any = _open.get(name)
    return keep(name, make) if kept is None else kept


def close_all() -> None:
    """Close everything that is open in this kernel, the newest first."""
    for name in reversed(tuple(_open)):
        _close(name)


async def until(condition: Callable[[], object], what: str = "", patience: float = PATIENCE) -> None:
    """Wait until something is so; the kernel stays free meanwhile.

    Args:
        condition: called again and again, until what it returns counts as true.
        what: what is waited for, as the error should say it.
        patience: how long at most [s].

    Raises:
        TutorialError: it has not become so.
    """
    deadline = time.monotonic() + patience
    while not condition():
        if time.monotonic() > deadline:
            vain = f"in vain for {what}" if what else "in vain"
            raise TutorialError(f"waited {patience:g} s {vain}. Run the cells above, in order, then this one.")
        await asyncio.sleep(LOOK_EVERY)


def log() -> None:
    """Print what the library has logged since this was last called. It comes from any thread, so no cell shows it."""
    while _lines.kept:
        print(_lines.kept.popleft())  # noqa: T201 - what it is for


class _Lines(logging.Handler):
    """Keeps what is logged. A line printed by another thread would appear below whichever cell was run last."""

    def __init__(self) -> None:
        super().__init__()
        self.kept: deque[str] = deque(maxlen=LINES_KEPT)

    def emit(self, record: logging.LogRecord) -> None:
        line = f"[{record.levelname}] {record.getMessage()}"
        if record.exc_info and record.exc_info[1] is not None:
            line += f": {type(record.exc_info[1]).__name__}: {record.exc_info[1]}"
        self.kept.append(line)


def _close(name: str) -> None:
    thing = _open.pop(name, None)
    if thing is not None:
        thing.close()


_lines = _Lines()
_logger = logging.getLogger("tutorial")
_logger.addHandler(_lines)
_logger.propagate = False
atexit.register(close_all)
