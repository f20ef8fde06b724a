"""Tests that run in an event loop, and what they wait for there."""

import asyncio
from collections.abc import Callable, Coroutine
from functools import wraps

PATIENCE = 60.0
"""How long a condition may take to come true [s]: long, for both cores may be busy."""


def in_a_loop(test: Callable[..., Coroutine[None, None, None]]) -> Callable[..., None]:
    """Run an async test to its end."""

    @wraps(test)
    def run(**fixtures: object) -> None:
        asyncio.run(asyncio.wait_for(test(**fixtures), 4 * PATIENCE))

    return run


async def until(condition: Callable[[], object]) -> None:
    """Wait until something is so, and fail if it never is."""
    async with asyncio.timeout(PATIENCE):
        while not condition():
            await asyncio.sleep(0.005)
