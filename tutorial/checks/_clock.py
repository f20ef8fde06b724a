"""An event loop whose clock stands still, so that what a timer does can be looked at, however busy the machine is."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextvars import Context
from typing import TypeVarTuple

__all__ = ["ClockedLoop"]

Ts = TypeVarTuple("Ts")

BEGAN = 1024.0  # [s] on the clock; with times of powers of two every sum is exact
TURNS = 10  # of the loop after a timer: what it calls, and what that calls
MOST = 10_000  # timers in one `advance`


class ClockedLoop(asyncio.SelectorEventLoop):
    """An event loop whose time passes only in `advance`, and then at once.

    Attributes:
        wrap: what a timer's function becomes before it is kept, with the function's arguments unchanged.
    """

    def __init__(self) -> None:
        self._now = BEGAN
        self._timers: list[asyncio.TimerHandle] = []
        self.wrap: Callable[[Callable[..., object]], Callable[..., object]] = lambda function: function
        super().__init__()

    def time(self) -> float:
        """Return what the clock says [s]."""
        return self._now

    def call_at(
        self, when: float, callback: Callable[[*Ts], object], *args: *Ts, context: Context | None = None
    ) -> asyncio.TimerHandle:
        """Keep a timer, as asyncio does; `call_later` comes this way, too."""
        wrapped = self.wrap(callback)
        timer = super().call_at(when, lambda: wrapped(*args), context=context)
        self._timers.append(timer)
        return timer

    @property
    def timers(self) -> list[asyncio.TimerHandle]:
        """The timers that are still to come."""
        return [timer for timer in self._timers if not timer.cancelled() and timer.when() > self._now]

    def advance(self, seconds: float = 0.0) -> None:
        """Let time pass, and run what is due, the earliest first.

        Args:
            seconds: how much [s].
        """
        end = self._now + seconds
        self._turn()
        for _ in range(MOST):
            self._timers = self.timers
            due = [timer.when() for timer in self._timers if timer.when() <= end]
            if not due:
                break
            self._now = min(due)
            self._turn()
        self._now = end

    def within(self, function: Callable[[], object]) -> None:
        """Call a function as a cell or a posted call is called, while the loop is running."""

        async def call() -> None:
            function()

        self.run_until_complete(call())

    def _turn(self) -> None:
        async def turns() -> None:
            for _ in range(TURNS):
                await asyncio.sleep(0)

        self.run_until_complete(turns())
