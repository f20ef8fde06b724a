"""Two threads in the order that is worst: another one's turn comes between any two instructions of a function."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from tutorial.checks._watch import watch

__all__ = ["interleave"]

TURN = 0.05  # [s]; who waits for a lock that the interrupted function holds gets no further, however long this is


def interleave(function: Callable[[], object], between: Callable[[], object], at: int | None) -> bool:
    """Run a function on this thread, and give another thread a turn in the middle of it, where it is the learner's.

    Which turn a scheduler gives is chance; this gives every one, so a race is found or excluded, not met or missed. A
    turn that cannot go on, because the function holds a lock, ends after the function.

    Args:
        function: what to run and to interrupt.
        between: what the other thread runs.
        at: before which instruction, counted from 0; None for before every one.

    Returns:
        Whether the function had so many instructions.

    Raises:
        Exception: whatever the function or the other thread raised.
    """
    other = _Other(between, at)

    def step(_frame: FrameType, event: str, _argument: Any) -> Any:
        if event in ("opcode", "line"):
            other.instruction()
        return step

    def enter(frame: FrameType, _event: str, _argument: Any) -> Any:
        if frame.f_code.co_filename not in watch.files:
            return None
        frame.f_trace_opcodes = True
        return step

    with _traced(enter), other:
        function()
    return at is None or other.count > at


class _Other:
    """The other thread. Leaving ``with`` waits for its turn to end, and raises what it raised.

    Args:
        between: what it runs in its turn.
        at: the instruction before which it has its turn; None for before every one.

    Attributes:
        count: how many instructions there were.
    """

    def __init__(self, between: Callable[[], object], at: int | None) -> None:
        self._between = between
        self._at = at
        self._turn: threading.Thread | None = None
        self._errors: list[Exception] = []
        self.count = 0

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._turn is not None:
            self._turn.join()
        if self._errors and kind is None:
            raise self._errors[0]

    def instruction(self) -> None:
        """Give it its turn, if it is due and the last one is over; then comes the next instruction."""
        if self._at in (None, self.count) and (self._turn is None or not self._turn.is_alive()):
            self._turn = threading.Thread(target=self._run, daemon=True)
            self._turn.start()
            self._turn.join(TURN)
        self.count += 1

    def _run(self) -> None:
        try:
            self._between()
        except Exception as error:  # noqa: BLE001 - it is raised where somebody hears it
            self._errors.append(error)


@contextmanager
def _traced(enter: Callable[[FrameType, str, Any], Any]) -> Iterator[None]:
    """Have this thread's code traced, instruction by instruction."""
    before = sys.gettrace()
    sys._getframe().f_trace_opcodes = True  # Python 3.12 and 3.13 look only at settrace whether some frame wants them
    watch.interleaved = True
    sys.settrace(enter)
    try:
        yield
    finally:
        sys.settrace(before)
        watch.interleaved = False
