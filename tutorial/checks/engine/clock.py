"""An event loop on a simulated clock, so that timers can be tested however busy the machine is."""

import asyncio
import threading
from collections.abc import Callable, Coroutine
from contextvars import Context
from selectors import DefaultSelector
from typing import Any

from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial

BEGAN = 1024.0  # [s] on the clock; with times of powers of two every sum is exact
TURN = 2.0**-17  # [s] that each turn of the loop takes, so that time also passes for code that asks for turns for ever
TURNS = 20  # of the loop after a timer: for what the timer calls, and for what that calls

OTHER_THREAD = "Non-thread-safe operation invoked on an event loop other than the current one"  # as asyncio says it
AT_ONCE = "You probably call it at once, with parentheses. Pass the function itself, such as self.land."


class ClockedLoop(asyncio.SelectorEventLoop):
    """An event loop whose time passes only in `advance`, and then at once. The learner's clocks agree with it.

    Args:
        trial: the trial whose clocks it puts ahead.

    Attributes:
        wrap: wraps each function of the learner's that is to be called later.
        posted: how many calls other threads have posted to the loop.
    """

    def __init__(self, trial: Trial) -> None:
        self._trial = trial
        self._now, self._timers = BEGAN, list[asyncio.TimerHandle]()
        self.wrap: Callable[[Callable[..., object]], Callable[..., object]] = lambda function: function
        self.posted, self._thread = 0, threading.get_ident()
        super().__init__(_Selector(self._wait))

    def time(self) -> float:
        """Return the simulated time [s]."""
        return self._now

    def call_at(self, when: float, callback: Any, *args: Any, context: Context | None = None) -> asyncio.TimerHandle:  # type: ignore[override]
        """Keep a timer, as asyncio does; `call_later` calls this, too."""
        self._check()
        if not callable(callback):
            raise Misuse(f"the timer gets {callback} instead of a function", AT_ONCE)
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
        """Make a task whose exception is reported at once, even if the learner keeps the task."""
        task = super().create_task(coro, **options)
        task.add_done_callback(lambda done: done.cancelled() or done.result())
        return task

    def close(self) -> None:
        """Cancel the tasks that still wait, and close the loop."""
        for task in asyncio.all_tasks(self):
            task.cancel()
        self.advance()
        super().close()

    @property
    def timers(self) -> list[asyncio.TimerHandle]:
        """The timers that have not fired yet."""
        return [timer for timer in self._timers if not timer.cancelled() and timer.when() > self._now]

    def advance(self, seconds: float = 0.0) -> None:
        """Let time pass [s], and run what is due, the earliest first, and what is posted in the meantime."""

        async def pass_time() -> None:
            await asyncio.sleep(seconds)
            for _ in range(TURNS):
                await asyncio.sleep(0)

        self.run_until_complete(pass_time())

    def _wait(self, seconds: float) -> None:
        """Let time pass instead of waiting."""
        passed = max(seconds, TURN)
        self._now += passed
        self._trial.ahead += passed

    def _check(self) -> None:
        """Refuse calls from other threads, as asyncio does in debug mode; without that they might never run."""
        if threading.get_ident() != self._thread and not self._trial.is_interleaved:
            raise RuntimeError(OTHER_THREAD)


class _Selector(DefaultSelector):
    """A selector that lets simulated time pass instead of waiting for events."""

    def __init__(self, wait: Callable[[float], None]) -> None:
        super().__init__()
        self._wait = wait

    def select(self, timeout: float | None = None) -> Any:
        self._wait(timeout or 0.0)
        return super().select(0)
