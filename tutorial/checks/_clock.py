"""An event loop whose clock stands still, so that what a timer does can be looked at, however busy the machine is."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine
from contextvars import Context
from typing import Any, TypeVarTuple

from tutorial.checks._diagnose import Misuse
from tutorial.checks._watch import watch

__all__ = ["ClockedLoop"]

Ts = TypeVarTuple("Ts")

BEGAN = 1024.0  # [s] on the clock; with times of powers of two every sum is exact
TURNS = 10  # of the loop after a timer: what it calls, and what that calls
MOST = 10_000  # timers in one `advance`

OTHER_THREAD = "Non-thread-safe operation invoked on an event loop other than the current one"  # as asyncio says it
AT_ONCE = (
    "Most likely the parentheses call the function at once, and it is not called later: give call_later the function "
    "itself, self.land."
)


class ClockedLoop(asyncio.SelectorEventLoop):
    """An event loop whose time passes only in `advance`, and then at once; so does that of the learner's clocks.

    Attributes:
        wrap: what a function of the learner's becomes before it is kept, with the function's arguments unchanged.
        posted: how many calls other threads have posted to it.
    """

    def __init__(self) -> None:
        self._now = BEGAN
        self._timers: list[asyncio.TimerHandle] = []
        self.wrap: Callable[[Callable[..., object]], Callable[..., object]] = lambda function: function
        self.posted, self._thread = 0, threading.get_ident()
        super().__init__()
        self.set_task_factory(self._task)  # type: ignore[arg-type]

    def time(self) -> float:
        """Return what the clock says [s]."""
        return self._now

    def call_at(
        self, when: float, callback: Callable[[*Ts], object], *args: *Ts, context: Context | None = None
    ) -> asyncio.TimerHandle:
        """Keep a timer, as asyncio does; `call_later` comes this way, too."""
        self._check()
        if not callable(callback):
            raise Misuse(f"the timer is given {callback} in place of a function", AT_ONCE)
        wrapped = self.wrap(callback)
        timer = super().call_at(when, lambda: wrapped(*args), context=context)
        self._timers.append(timer)
        return timer

    def call_soon(
        self, callback: Callable[[*Ts], object], *args: *Ts, context: Context | None = None
    ) -> asyncio.Handle:
        """Call in the next turn, as asyncio does."""
        self._check()
        return super().call_soon(callback, *args, context=context)

    def call_soon_threadsafe(
        self, callback: Callable[[*Ts], object], *args: *Ts, context: Context | None = None
    ) -> asyncio.Handle:
        """Call in the next turn, from any thread."""
        self.posted += 1
        wrapped = self.wrap(callback)
        return super().call_soon_threadsafe(lambda: wrapped(*args), context=context)

    def close(self) -> None:
        """Close it; tasks that still wait are cancelled before."""
        for task in asyncio.all_tasks(self):
            task.cancel()
        self._turn()
        super().close()

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
            self._pass(min(due))
            self._turn()
        self._pass(end)

    def _pass(self, now: float) -> None:
        clocks = watch.clocks or {}
        for name in clocks:
            clocks[name] += (now - self._now) * (1_000_000_000 if name.endswith("_ns") else 1)
        self._now = now

    def _check(self) -> None:
        """Refuse other threads, as asyncio does where it debugs; else a call of theirs may never run."""
        if threading.get_ident() != self._thread:
            raise RuntimeError(OTHER_THREAD)

    def _task(self, _: object, coroutine: Coroutine[Any, Any, Any], **options: Any) -> asyncio.Task[Any]:
        """Make a task, and say at once what it raises, even where somebody keeps it."""
        task = asyncio.Task(coroutine, loop=self, **options)
        task.add_done_callback(self._done)
        return task

    def _done(self, task: asyncio.Task[Any]) -> None:
        error = None if task.cancelled() else task.exception()
        if error is not None:
            self.call_exception_handler({"message": "a task has failed", "exception": error})

    def _turn(self) -> None:
        async def turns() -> None:
            for _ in range(TURNS):
                await asyncio.sleep(0)

        self.run_until_complete(turns())
