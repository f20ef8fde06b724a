"""A result that comes later."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

__all__ = ["Future"]


class Future:
    """A result that comes later; may be set and read on any thread.

    ``rclpy.spin_until_future_complete`` waits for it while callbacks run.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._callbacks: list[Callable[[Future], object]] = []
        self._done = False
        self._cancelled = False
        self._result: Any = None
        self._exception: BaseException | None = None

    def done(self) -> bool:
        """Whether there is a result or an exception, or it has been cancelled."""
        return self._done or self._cancelled

    def cancelled(self) -> bool:
        """Whether it has been cancelled."""
        return self._cancelled

    def result(self) -> Any:
        """Return the result, None if there is none yet.

        Raises:
            BaseException: that which was set instead of a result.
        """
        if self._exception is not None:
            raise self._exception
        return self._result

    def exception(self) -> BaseException | None:
        """Return the exception that was set instead of a result."""
        return self._exception

    def set_result(self, result: Any) -> None:
        """Give it its result."""
        self._finish(result=result)

    def set_exception(self, exception: BaseException) -> None:
        """Give it an exception instead of a result."""
        self._finish(exception=exception)

    def cancel(self) -> None:
        """Say that the result is no longer wanted."""
        self._finish(cancelled=True)

    def add_done_callback(self, callback: Callable[[Future], object]) -> None:
        """Call back when it is done, at once if it is."""
        with self._lock:
            if not self.done():
                self._callbacks.append(callback)
                return
        callback(self)

    def _finish(self, result: Any = None, exception: BaseException | None = None, cancelled: bool = False) -> None:
        with self._lock:
            if self.done():
                return
            self._result, self._exception, self._cancelled = result, exception, cancelled
            self._done = not cancelled
            callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            callback(self)
