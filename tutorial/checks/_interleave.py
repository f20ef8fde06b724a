"""Two threads in the order that is worst: another one's turn comes between any two instructions of a function."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any

from tutorial.checks._watch import watch

__all__ = ["interleave"]

TURN = 0.05  # [s]; who waits for a lock that the interrupted function holds gets no further, however long this is


def interleave(function: Callable[[], object], files: set[str], between: Callable[[], object], at: int | None) -> bool:
    """Run a function on this thread, and give another thread a turn in the middle of it.

    Which turn a scheduler gives is chance; this gives every one, so a race is found or excluded, not met or missed. A
    turn that cannot go on, because the function holds a lock, ends after the function.

    Args:
        function: what to run and to interrupt.
        files: the files of the code that may be interrupted.
        between: what the other thread runs.
        at: before which instruction, counted from 0; None for before every one.

    Returns:
        Whether the function had so many instructions.

    Raises:
        Exception: whatever the function or the other thread raised.
    """
    count = 0
    turn: threading.Thread | None = None
    errors: list[Exception] = []

    def take_turn() -> None:
        try:
            between()
        except Exception as error:  # noqa: BLE001 - it is raised where somebody hears it
            errors.append(error)

    def step(_frame: FrameType, event: str, _argument: Any) -> Any:
        nonlocal count, turn
        if event in ("opcode", "line"):
            if at in (None, count) and (turn is None or not turn.is_alive()):
                turn = threading.Thread(target=take_turn, daemon=True)
                turn.start()
                turn.join(TURN)
            count += 1
        return step

    def enter(frame: FrameType, _event: str, _argument: Any) -> Any:
        if frame.f_code.co_filename not in files:
            return None
        frame.f_trace_opcodes = True
        return step

    before = sys.gettrace()
    sys._getframe().f_trace_opcodes = True  # Python 3.12 and 3.13 look only at settrace whether some frame wants them
    watch.interleaved = True
    sys.settrace(enter)
    try:
        function()
    finally:
        sys.settrace(before)
        if turn is not None:
            turn.join()
        watch.interleaved = False
    if errors:
        raise errors[0]
    return at is None or count > at
