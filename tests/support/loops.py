"""Run tests in an event loop, and wait for conditions there."""

import asyncio
import time
from collections.abc import Callable, Coroutine
from functools import wraps
from inspect import isawaitable

import pytest

TIMEOUT = 60.0
"""How long a condition may take to come true [s]. Both cores may be busy, and only a failing test waits so long."""


def in_a_loop(test: Callable[..., Coroutine[None, None, None]]) -> Callable[..., None]:
    """Run an async test to its end."""

    @wraps(test)
    def run(**fixtures: object) -> None:
        asyncio.run(asyncio.wait_for(test(**fixtures), 4 * TIMEOUT))

    return run


async def until(condition: Callable[[], object], what: str = "the condition", timeout: float = TIMEOUT) -> None:
    """Wait until a condition holds, and fail if it never does.

    Args:
        condition: a function, which may be async.
        what: the name of the condition, for the error.
        timeout: the longest time to wait [s].
    """
    deadline = time.monotonic() + timeout
    while not await _result(condition):
        if time.monotonic() > deadline:
            pytest.fail(f"timed out after {timeout:.0f} s waiting for {what}")
        await asyncio.sleep(0.02)


async def _result(condition: Callable[[], object]) -> object:
    result = condition()
    return await result if isawaitable(result) else result
