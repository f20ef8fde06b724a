"""Futures: results that become available later."""

from __future__ import annotations

import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy import _absent


class Future:
    """A result that becomes available later; can be set and read on any thread.

    ``rclpy.spin_until_future_complete`` runs callbacks until the future is done.

    Args:
        executor: not supported by the pocket ROS 2.
    """

    def __init__(self, *, executor: None = None) -> None:
        _absent.refuse("Future", {"executor": executor})
        self._lock = threading.Lock()
        self._callbacks: list[Callable[[Future], object]] = []
        self._done = self._cancelled = False
        self._result: Any = None
        self._exception: Exception | None = None
        self._exception_fetched = False

    def __del__(self) -> None:
        if self._exception is not None and not self._exception_fetched:
            sys.stderr.write(f"The following exception was never retrieved: {self._exception}\n")

    def done(self) -> bool:
        """Return whether the future has a result or an exception."""
        return self._done

    def cancelled(self) -> bool:
        """Return whether the future has been cancelled and is not done."""
        return self._cancelled

    def result(self) -> Any:
        """Return the result, or None if there is no result yet; if an exception was set instead, raise it."""
        if exception := self.exception():
            raise exception
        return self._result

    def exception(self) -> Exception | None:
        """Return the exception that was set instead of a result, or None if no exception was set."""
        self._exception_fetched = True
        return self._exception

    def set_result(self, result: Any) -> None:
        """Set the result."""
        self._finish(_result=result, _done=True, _cancelled=False)

    def set_exception(self, exception: Exception) -> None:
        """Set an exception instead of a result."""
        self._finish(_exception=exception, _exception_fetched=False, _done=True, _cancelled=False)

    def cancel(self) -> None:
        """Cancel the future, unless it is done."""
        self._finish(_cancelled=not self._done)

    def add_done_callback(self, callback: Callable[[Future], object]) -> None:
        """Call a function when the future is done or cancelled, or at once if it is already done."""
        with self._lock:
            if not self._done:
                self._callbacks.append(callback)
                return
        callback(self)

    @contextmanager
    def _telling(self, callback: Callable[[Future], object]) -> Iterator[None]:
        """Add a done callback, and remove it at the end of the block."""
        self.add_done_callback(callback)
        try:
            yield
        finally:
            with self._lock:
                self._callbacks = [other for other in self._callbacks if other is not callback]

    def _finish(self, **state: Any) -> None:
        with self._lock:
            vars(self).update(state)
            callbacks, self._callbacks = self._callbacks, []
        for callback in callbacks:
            try:
                callback(self)
            except Exception as error:  # noqa: BLE001  (a callback can raise anything)
                warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=2)
