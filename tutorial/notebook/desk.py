"""What is open in this kernel, by name, and what the library has said meanwhile."""

from __future__ import annotations

import asyncio
import atexit
import logging
import time
from collections import deque
from collections.abc import Callable
from typing import Any, TypeVar

from tutorial.errors import TutorialError

__all__ = ["close_all", "keep", "keep_once", "log", "until"]

PATIENCE = 30.0  # [s] that `until` waits: a classroom's server may be slow
LOOK_EVERY = 0.01  # [s] between two looks at a condition
LINES_KEPT = 100


T = TypeVar("T")

_open: dict[str, tuple[Any, Callable[[], object]]] = {}


def keep(name: str, make: Callable[[], T], let_go: Callable[[T], object]) -> T:
    """Make something and keep it under a name, after letting go what was kept under it.

    Args:
        name: what it is called, for instance ``"program simulation"``.
        make: makes it.
        let_go: lets it go.
    """
    _let_go(name)
    made = make()
    _open[name] = made, lambda: let_go(made)
    return made


def keep_once(name: str, make: Callable[[], T], let_go: Callable[[T], object]) -> T:
    """As `keep`, but what is kept already stays and is returned."""
    return _open[name][0] if name in _open else keep(name, make, let_go)


def close_all() -> None:
    """Close everything that is open in this kernel, the newest first. What was shown last stays on the page."""
    for name in reversed(tuple(_open)):
        _let_go(name)


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


def _let_go(name: str) -> None:
    if name in _open:
        _, let_go = _open.pop(name)
        let_go()


_lines = _Lines()
_logger = logging.getLogger("tutorial")
_logger.addHandler(_lines)
_logger.propagate = False
atexit.register(close_all)
