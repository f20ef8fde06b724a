"""An event loop on a simulated clock, so that timer tests work even on a busy machine."""

import asyncio
import threading
from collections.abc import Callable, Coroutine
from contextvars import Context
from selectors import DefaultSelector
from typing import Any

from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial

BEGAN = 1024.0  # [s] the clock's initial time; sums of powers of two are exact
TURN = 2.0**-17  # [s] how long each turn of the loop takes, so that time passes even while code loops on sleep(0)
TURNS = 20  # turns after a timer fires: enough for the calls that it schedules, and the calls that those schedule

OTHER_THREAD = "Non-thread-safe operation invoked on an event loop other than the current one"  # asyncio's own text
AT_ONCE = (
    "Your code probably calls the function immediately, with parentheses. Pass the function itself, such as self.land."
)


class ClockedLoop(asyncio.SelectorEventLoop):
    """An event loop with a simulated clock: only `advance` moves the time forward, without waiting.

    The learner's clocks show the same time.

    Args:
        trial: the trial whose clocks the loop advances.

    Attributes:
        wrap: wraps each of the learner's functions that the loop will call.
        posted: how many calls were posted with `call_soon_threadsafe`.
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
        """Start a timer, as asyncio does. `call_later` uses this method, too."""
        self._check()
        if not callable(callback):
            raise Misuse(f"the timer gets {callback} instead of a function", AT_ONCE)
        timer = super().call_at(when, self.wrap(callback), *args, context=context)
        self._timers.append(timer)
        return timer

    def call_soon(self, callback: Any, *args: Any, context: Context | None = None) -> asyncio.Handle:  # type: ignore[override]
        """Call a function in the next iteration of the loop, as asyncio does."""
        self._check()
        return super().call_soon(callback, *args, context=context)

    def call_soon_threadsafe(self, callback: Any, *args: Any, context: Context | None = None) -> asyncio.Handle:  # type: ignore[override]
        """Call a function in the next turn, from any thread."""
        self.posted += 1
        return super().call_soon_threadsafe(self.wrap(callback), *args, context=context)

    def create_task(self, coro: Coroutine[Any, Any, Any], **options: Any) -> asyncio.Task[Any]:  # type: ignore[override]
        """Make a task whose exception is reported immediately, even if the learner keeps a reference to the task."""
        task = super().create_task(coro, **options)
        task.add_done_callback(lambda done: done.cancelled() or done.result())
        return task

    def close(self) -> None:
        """Cancel the pending tasks, and close the loop."""
        for task in asyncio.all_tasks(self):
            task.cancel()
        self.advance()
        super().close()

    @property
    def timers(self) -> list[asyncio.TimerHandle]:
        """The timers that have not fired yet."""
        return [timer for timer in self._timers if not timer.cancelled() and timer.when() > self._now]

    def advance(self, seconds: float = 0.0) -> None:
        """Advance the clock [s], and run all calls that become due or are posted in the meantime, earliest first."""

        async def pass_time() -> None:
            await asyncio.sleep(seconds)
            for _ in range(TURNS):
                await asyncio.sleep(0)

        self.run_until_complete(pass_time())

    def _wait(self, seconds: float) -> None:
        """Advance the simulated time instead of waiting."""
        passed = max(seconds, TURN)
        self._now += passed
        self._trial.ahead += passed

    def _check(self) -> None:
        """Reject calls from other threads, as asyncio does in debug mode, because they might never run."""
        if threading.get_ident() != self._thread and not self._trial.is_interleaved:
            raise RuntimeError(OTHER_THREAD)


class _Selector(DefaultSelector):
    """A selector that advances the simulated time instead of waiting for events."""

    def __init__(self, wait: Callable[[float], None]) -> None:
        super().__init__()
        self._wait = wait

    def select(self, timeout: float | None = None) -> Any:
        self._wait(timeout or 0.0)
        return super().select(0)
