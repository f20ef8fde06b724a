"""Interleaving: find races between two threads, by running one thread between any two instructions of the other."""

import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from types import FrameType
from typing import Any

from tutorial.checks.engine.cases import Run
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.memory_node import MemoryNode
from tutorial.checks.engine.trial import Trial

# The other thread may need a lock that the interrupted function holds. So the function waits for the other thread's
# turn only this many times, and this long [s] each time. A single long wait would also time out if the machine or
# Python's garbage collector delayed the turn.
WAITS, WAIT = 50, 0.001
MESSAGES = 100  # messages that arrive while a controller is being configured, one at each instruction

EARLY = "Your code probably creates the subscription before the attributes that its callback uses. Create it last."


def interleave(trial: Trial, function: Callable[[], object], between: Callable[[], object], at: int | None) -> bool:
    """Run a function on this thread, and interrupt the learner's code in it from another thread.

    A scheduler interrupts threads at random. With this function, a check can interrupt the code at every instruction,
    so it either finds a race or rules it out. If the other thread waits for a lock that the function holds, the
    function continues in the meantime.

    Args:
        trial: the trial whose code is interrupted.
        function: the function to run on this thread.
        between: the function to run on the other thread.
        at: the number of the instruction before which the code is interrupted, counting from 0; None for every
            instruction.

    Returns:
        Whether the function reached that instruction.

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
                for _ in range(WAITS):
                    if wait(turns[-1:], WAIT).done:
                        break
            count += 1
        return step

    def enter(frame: FrameType, _event: str, _argument: Any) -> Any:
        if frame.f_code.co_filename not in trial.watched:
            return None
        frame.f_trace = step  # Python 3.13 traces instructions only if this is set first
        frame.f_trace_opcodes = True
        return step

    with traced(trial, enter), ThreadPoolExecutor(1) as other:
        function()
    for turn in turns:
        turn.result()  # raises the other thread's exception
    return at is None or count > at


@contextmanager
def traced(trial: Trial, enter: Callable[[FrameType, str, Any], Any]) -> Iterator[None]:
    """Trace this thread's code, instruction by instruction in frames that request it."""
    before = sys.gettrace()
    sys._getframe().f_trace_opcodes = True  # Python 3.12 reads this frame attribute only in settrace
    trial.is_interleaved = True
    sys.settrace(enter)
    try:
        yield
    finally:
        sys.settrace(before)
        trial.is_interleaved = False


def early(make: Callable[..., Any], message: Any) -> Run:
    """Observe whether the callback can run as soon as the subscription exists, while `configure` is still running.

    Args:
        make: given a trial and a node, makes a `Rig` or a `Viewer`, which configures the controller.
        message: the message that arrives between any two instructions of `configure`.
    """

    def run(trial: Trial) -> str:
        def arrive() -> None:
            for callback, _ in zip(node.listeners(message), left):
                try:
                    trial.call(callback, message)
                except Failure as failure:
                    text = f"the first message arrives while configure runs: {failure.error}"
                    raise Failure(failure.method, Misuse(text, EARLY), failure.place) from failure

        node, left = MemoryNode(trial), iter(range(MESSAGES))
        interleave(trial, lambda: make(trial, node=node), arrive, None)
        return "the callback can handle it"

    return run
