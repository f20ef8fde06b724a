"""Clocks."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any, Self, cast

from rclpy import _rclpy_pybind11
from rclpy.clock_type import ClockType
from rclpy.constants import S_TO_NS
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.time import Time
from rclpy.utilities import get_default_context

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.timer import Timer


LONGEST_WAIT = 0.1
"""Maximum length of one wait [s]: between waits, a sleeper checks whether a signal or a call has shut the
context down."""


class Clock:
    """A clock.

    Args:
        clock_type: kind of time; ROS time is system time unless the node uses simulated time.

    Raises:
        TypeError: the clock type is not a ClockType.
    """

    _clock_type: ClockType
    _timers: set[Timer]  # timers that use this clock
    _jumped: threading.Condition  # notified when the simulated time changes
    _switches = 0  # number of switches between system time and simulated time
    _is_simulated = False
    _simulated_ns = 0  # the simulated time

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Self:
        """Create a clock; if its type is ROS time, create a ROSClock."""
        if not isinstance(clock_type, (ClockType, _rclpy_pybind11.ClockType)):
            raise TypeError("Clock type must be a ClockType enum")
        self: Any = object.__new__(ROSClock if clock_type == ClockType.ROS_TIME else cls)
        self._clock_type, self._timers, self._jumped = clock_type, set(), threading.Condition()
        return cast(Self, self)

    @property
    def clock_type(self) -> ClockType:
        """The kind of clock."""
        return self._clock_type

    def now(self) -> Time:
        """Return the current time; simulated time is 0 before the first message on ``/clock``."""
        system_ns = time.monotonic_ns() if self._clock_type == ClockType.STEADY_TIME else time.time_ns()
        return Time(nanoseconds=self._simulated_ns if self._is_simulated else system_ns, clock_type=self._clock_type)

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until the clock reaches a given time. A simulated clock follows the messages on ``/clock``.

        Args:
            until: when to wake up.
            context: a context whose shutdown ends the sleep; if None, the default context.

        Returns:
            Whether the time was reached: False if the context was shut down, or if the clock switched between
            system time and simulated time.

        Raises:
            NotInitializedException: the context is not running.
            ValueError: the time is from a different type of clock.
        """
        context = context or get_default_context()
        if not context.ok():
            raise NotInitializedException
        if until.clock_type.value != self._clock_type.value:
            raise ValueError("until's clock type does not match this clock's type")
        switches = self._switches
        with self._jumped:
            while (left := until.nanoseconds - self.now().nanoseconds) > 0:
                self._jumped.wait(LONGEST_WAIT if self._is_simulated else min(left / S_TO_NS, LONGEST_WAIT))
                if not context.ok() or self._switches != switches:
                    return False
        return True

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a duration; see :meth:`sleep_until`."""
        return self.sleep_until(self.now() + rel_time, context)

    def _timer_ns(self) -> int:
        """Return the time that timers use [ns]. Changes to the system clock do not affect it."""
        return self._simulated_ns if self._is_simulated else time.monotonic_ns()

    def __repr__(self) -> str:
        return f"Clock(clock_type={self._clock_type.name})"


class ROSClock(Clock):
    """A node's clock: system time or, while the node uses simulated time, the time from ``/clock``."""

    def __new__(cls) -> Self:
        """Create a ROS time clock."""
        return super().__new__(cls, clock_type=ClockType.ROS_TIME)

    @property
    def ros_time_is_active(self) -> bool:
        """Whether the time is simulated."""
        return self._is_simulated

    def set_ros_time_override(self, time: Time) -> None:
        """Set the simulated time.

        Raises:
            TypeError: the argument is not a Time.
        """
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        self._jump(self._is_simulated, time.nanoseconds)

    def _jump(self, is_simulated: bool, simulated_ns: int) -> None:
        """Set the simulated time and whether the clock uses it, then wake the sleepers and adjust the timers."""
        before, switched = self._timer_ns(), is_simulated != self._is_simulated
        with self._jumped:
            self._is_simulated, self._simulated_ns = is_simulated, simulated_ns
            self._switches += switched
            self._jumped.notify_all()
        for timer in tuple(self._timers):
            timer.clock_has_jumped(before, switched)
