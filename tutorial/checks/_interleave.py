"""Two threads in the order that is worst: another one's turn comes between any two instructions of a function."""

import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from types import FrameType
from typing import Any

from tutorial.checks._watch import watch

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
    count = 0
    turns: list[Future[object]] = []

    def step(_frame: FrameType, event: str, _argument: Any) -> Any:
        nonlocal count
        if event in ("opcode", "line"):
            if at in (None, count) and (not turns or turns[-1].done()):
                turns.append(other.submit(between))
                wait(turns[-1:], TURN)
            count += 1
        return step

    def enter(frame: FrameType, _event: str, _argument: Any) -> Any:
        if frame.f_code.co_filename not in watch.files:
            return None
        frame.f_trace = step  # Python 3.13 stops at instructions only where this stands already
        frame.f_trace_opcodes = True
        return step

    with traced(enter), ThreadPoolExecutor(1) as other:
        function()
    for turn in turns:
        turn.result()  # raises what it has raised
    return at is None or count > at


@contextmanager
def traced(enter: Callable[[FrameType, str, Any], Any]) -> Iterator[None]:
    """Have this thread's code traced, instruction by instruction where a frame asks for it."""
    before = sys.gettrace()
    sys._getframe().f_trace_opcodes = True  # Python 3.12 looks only at settrace whether some frame wants them
    watch.interleaved = True
    sys.settrace(enter)
    try:
        yield
    finally:
        sys.settrace(before)
        watch.interleaved = False
