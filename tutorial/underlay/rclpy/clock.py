"""Clocks that tell the time."""

from __future__ import annotations

import time

from rclpy.clock_type import ClockType
from rclpy.time import Time

__all__ = ["Clock", "ClockType", "ROSClock"]


class Clock:
    """Tells the time.

    Args:
        clock_type: which time; ROS time is the system's time here, because the underlay has no simulated time.
    """

    def __init__(self, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> None:
        self._clock_type = clock_type

    @property
    def clock_type(self) -> ClockType:
        """The kind of clock."""
        return self._clock_type

    def now(self) -> Time:
        """Return the time now."""
        steady = self._clock_type is ClockType.STEADY_TIME
        return Time(nanoseconds=time.monotonic_ns() if steady else time.time_ns(), clock_type=self._clock_type)

    def __repr__(self) -> str:
        return f"Clock(clock_type={self._clock_type.name})"


class ROSClock(Clock):
    """A node's clock."""

    def __init__(self) -> None:
        super().__init__(clock_type=ClockType.ROS_TIME)
