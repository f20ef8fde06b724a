"""Tests that run in an event loop, and what they wait for there."""

import asyncio
import time
from collections.abc import Callable, Coroutine
from functools import wraps
from inspect import isawaitable

import pytest

PATIENCE = 60.0
"""How long a condition may take to come true [s]: long, for both cores may be busy."""


def in_a_loop(test: Callable[..., Coroutine[None, None, None]]) -> Callable[..., None]:
    """Run an async test to its end."""

    @wraps(test)
    def run(**fixtures: object) -> None:
        asyncio.run(asyncio.wait_for(test(**fixtures), 4 * PATIENCE))

    return run


async def until(condition: Callable[[], object], what: str = "the condition", patience: float = PATIENCE) -> None:
    """Wait until a condition holds, and fail if it never does.

    Args:
        condition: a function, which may be async.
        what: what to wait for, for the error.
        patience: how long to wait at most [s].
    """
    deadline = time.monotonic() + patience
    while not await _result(condition):
        if time.monotonic() > deadline:
            pytest.fail(f"waited {patience:.0f} s in vain for {what}")
        await asyncio.sleep(0.02)


async def _result(condition: Callable[[], object]) -> object:
    result = condition()
    return await result if isawaitable(result) else result
