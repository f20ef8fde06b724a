"""Timers."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING

from rclpy._rclpy_pybind11 import Destroyable, RCLError
from rclpy.clock import LONGEST_WAIT, Clock
from rclpy.constants import S_TO_NS
from rclpy.context import NOT_VALID
from rclpy.exceptions import InvalidHandle, ROSInterruptException

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.node import Node


class Timer(Destroyable):
    """Runs a callback periodically; created by ``Node.create_timer``.

    The callback runs on the thread that spins. If the spinning thread is late, missed calls are skipped and later calls
    stay on schedule, as in ROS 2. With simulated time, the timer fires when the time on ``/clock`` reaches the time of
    the next call. Once the timer is destroyed, its methods raise InvalidHandle.

    Args:
        node: the timer's node.
        callback: called without arguments.
        timer_period_ns: time between calls [ns].
        clock: the clock that measures the period.
        autostart: start immediately; if False, the timer starts when :meth:`reset` is called.

    Raises:
        RCLError: the period is negative, or the context is not running.
    """

    def __init__(
        self, node: Node, callback: Callable[[], object], timer_period_ns: int, clock: Clock, autostart: bool
    ) -> None:
        if timer_period_ns < 0 or not node.context.ok():
            reason = "timer period must be non-negative" if timer_period_ns < 0 else NOT_VALID
            raise RCLError(f"failed to create timer: {reason}")
        self._node = node
        self.callback = callback
        self.timer_period_ns = timer_period_ns
        self.clock = clock
        self._canceled = not autostart
        self._last_call = clock._timer_ns()
        self._next_call = self._last_call + timer_period_ns
        clock._timers.add(self)

    def is_ready(self) -> bool:
        """Return whether a call is due."""
        return not self._canceled and self._now() >= self._next_call

    def is_canceled(self) -> bool:
        """Return whether the timer has been stopped."""
        self._now()
        return self._canceled

    def cancel(self) -> None:
        """Stop the timer; :meth:`reset` restarts it."""
        self._now()
        self._canceled = True

    def reset(self) -> None:
        """Start the timer again: the next call is one period from now."""
        self._next_call = self._now() + self.timer_period_ns
        self._canceled = False
        self._node.wake_executor()

    def time_since_last_call(self) -> int:
        """Return the time since the last call [ns]."""
        return self._now() - self._last_call

    def time_until_next_call(self) -> int | None:
        """Return the time until the next call [ns], negative if the call is late; None if the timer is stopped."""
        until = self._next_call - self._now()
        return None if self._canceled else until

    def destroy(self) -> None:
        """Destroy the timer. Idempotent. As in rclpy, ``Node.timers`` still includes the timer."""
        self._node._remove(self, keep=True)

    def close(self) -> None:
        """Stop the timer permanently. Called by the node."""
        self._destroyed = True
        self.clock._timers.discard(self)

    def wait_time(self) -> float:
        """Return how long the executor can wait for the timer [s]; infinite if only ``/clock`` can trigger it."""
        left = self._next_call - self.clock._timer_ns()
        stands = left > 0 and self.clock._is_simulated
        return math.inf if self._destroyed or self._canceled or stands else left / S_TO_NS

    def execute(self) -> bool:
        """Run the callback if it is due. Called by the executor.

        Returns:
            Whether the callback was called.
        """
        if self.wait_time() > 0:
            return False
        self._last_call = now = self.clock._timer_ns()
        self._next_call += self.timer_period_ns
        if self._next_call < now:
            self._next_call = now + (self._next_call - now) % (self.timer_period_ns or 1)
        self.callback()
        return True

    def clock_has_jumped(self, before: int, switched: bool) -> None:
        """Handle a clock jump as rcl does: restart after a jump backwards, but keep the remaining time after a switch.

        Args:
            before: the clock's time before the jump [ns].
            switched: whether the clock switched between system time and simulated time.
        """
        now, period = self.clock._timer_ns(), self.timer_period_ns
        if switched and not now:  # no message on /clock yet: the first one counts as a jump backwards
            self._last_call = self._next_call = 2**63 - 1
        elif switched and before:
            self._last_call = now - (self._next_call - before)  # rcl also subtracts the remaining time
            self._next_call = self._last_call + period
        elif switched or now < self._last_call:
            self._last_call, self._next_call = now, now + period

    def _now(self) -> int:
        """Return the clock's time [ns]; raise InvalidHandle if the timer has been destroyed."""
        self._require_handle()
        return self.clock._timer_ns()


class Rate:
    """Sleeps at a fixed rate; created by ``Node.create_rate``.

    The node has to spin on another thread. In a callback that the node's executor runs, :meth:`sleep` never returns.

    Args:
        timer: the timer that wakes sleepers.
        context: a context whose shutdown also wakes the sleepers.
    """

    def __init__(self, timer: Timer, *, context: Context) -> None:
        self._timer = timer
        self._context = context
        self._is_destroyed = False
        self._wake_up = threading.Event()
        self._lock = threading.Lock()
        self._sleepers = 0
        timer.callback = self._wake_up.set

    def sleep(self) -> None:
        """Sleep until the timer fires. Return at once if it has fired since the last sleep.

        Raises:
            ROSInterruptException: the context has been shut down.
            RuntimeError: the rate has been destroyed.
            InvalidHandle: the rate's timer has been destroyed.
        """
        self._require_alive()
        with self._lock:
            self._sleepers += 1
        try:
            while not self._wake_up.wait(LONGEST_WAIT) and self._context.ok():
                pass
        finally:
            with self._lock:
                self._sleepers -= 1
                if not self._sleepers:
                    self._wake_up.clear()
        if not self._context.ok():
            raise ROSInterruptException

    def destroy(self) -> None:
        """Wake the sleepers, and reject later calls to :meth:`sleep`."""
        self._is_destroyed = True
        self._wake_up.set()

    def _require_alive(self) -> None:
        if not self._context.ok():
            raise ROSInterruptException
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        if self._timer._destroyed:
            self.destroy()
            raise InvalidHandle("Rate cannot sleep because the timer has been destroyed")
