"""An event loop whose clock stands still, so that what a timer does can be looked at, however busy the machine is."""

import asyncio
import threading
from collections.abc import Callable, Coroutine
from contextvars import Context
from selectors import DefaultSelector
from typing import Any

from tutorial.checks._watch import Misuse, watch

BEGAN = 1024.0  # [s] on the clock; with times of powers of two every sum is exact
TURN = 2.0**-17  # [s] that a turn of the loop takes: time passes also for what asks for another turn for ever
TURNS = 20  # of the loop after a timer: what it calls, and what that calls

OTHER_THREAD = "Non-thread-safe operation invoked on an event loop other than the current one"  # as asyncio says it
AT_ONCE = "Most likely the parentheses call it at once: give call_later the function itself, self.land."


class ClockedLoop(asyncio.SelectorEventLoop):
    """An event loop whose time passes only in `advance`, and then at once; so does that of the learner's clocks.

    Attributes:
        wrap: what a function of the learner's becomes before it is kept, with the function's arguments unchanged.
        posted: how many calls other threads have posted to it.
    """

    def __init__(self) -> None:
        self._now, self._timers = BEGAN, list[asyncio.TimerHandle]()
        self.wrap: Callable[[Callable[..., object]], Callable[..., object]] = lambda function: function
        self.posted, self._thread = 0, threading.get_ident()
        super().__init__(_Selector(self._wait))

    def time(self) -> float:
        """Return what the clock says [s]."""
        return self._now

    def call_at(self, when: float, callback: Any, *args: Any, context: Context | None = None) -> asyncio.TimerHandle:  # type: ignore[override]
        """Keep a timer, as asyncio does; `call_later` comes this way, too."""
        self._check()
        if not callable(callback):
            raise Misuse(f"the timer is given {callback} in place of a function", AT_ONCE)
        timer = super().call_at(when, self.wrap(callback), *args, context=context)
        self._timers.append(timer)
        return timer

    def call_soon(self, callback: Any, *args: Any, context: Context | None = None) -> asyncio.Handle:  # type: ignore[override]
        """Call in the next turn, as asyncio does."""
        self._check()
        return super().call_soon(callback, *args, context=context)

    def call_soon_threadsafe(self, callback: Any, *args: Any, context: Context | None = None) -> asyncio.Handle:  # type: ignore[override]
        """Call in the next turn, from any thread."""
        self.posted += 1
        return super().call_soon_threadsafe(self.wrap(callback), *args, context=context)

    def create_task(self, coro: Coroutine[Any, Any, Any], **options: Any) -> asyncio.Task[Any]:  # type: ignore[override]
        """Make a task, and say at once what it raises, even where somebody keeps it."""
        task = super().create_task(coro, **options)
        task.add_done_callback(lambda done: done.cancelled() or done.result())
        return task

    def close(self) -> None:
        """Close it; tasks that still wait are cancelled before."""
        for task in asyncio.all_tasks(self):
            task.cancel()
        self.advance()
        super().close()

    @property
    def timers(self) -> list[asyncio.TimerHandle]:
        """The timers that are still to come."""
        return [timer for timer in self._timers if not timer.cancelled() and timer.when() > self._now]

    def advance(self, seconds: float = 0.0) -> None:
        """Let time pass [s], and run what is due, the earliest first, and what is posted meanwhile."""

        async def pass_time() -> None:
            await asyncio.sleep(seconds)
            for _ in range(TURNS):
                await asyncio.sleep(0)

        self.run_until_complete(pass_time())

    def _wait(self, seconds: float) -> None:
        """Let time pass in place of waiting."""
        passed = max(seconds, TURN)
        self._now += passed
        watch.ahead += passed

    def _check(self) -> None:
        """Refuse other threads, as asyncio does where it debugs; else a call of theirs may never run."""
        if threading.get_ident() != self._thread and not watch.interleaved:
            raise RuntimeError(OTHER_THREAD)


class _Selector(DefaultSelector):
    """Waits as it is told to, rather than for something to happen."""

    def __init__(self, wait: Callable[[float], None]) -> None:
        super().__init__()
        self._wait = wait

    def select(self, timeout: float | None = None) -> Any:
        self._wait(timeout or 0.0)
        return super().select(0)
