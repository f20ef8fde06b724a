"""Clocks that tell the time."""

import time
from typing import Any, Self, cast

from rclpy import _rclpy_pybind11
from rclpy.clock_type import ClockType
from rclpy.time import Time


class Clock:
    """Tells the time.

    Args:
        clock_type: which time; ROS time is the system's time here, because the underlay has no simulated time.

    Raises:
        TypeError: it is no ClockType.
    """

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Self:
        """Make a clock, which for ROS time is a ROSClock."""
        if not isinstance(clock_type, (ClockType, _rclpy_pybind11.ClockType)):
            raise TypeError("Clock type must be a ClockType enum")
        self: Any = object.__new__(ROSClock if clock_type == ClockType.ROS_TIME else cls)
        self._clock_type = clock_type
        return cast(Self, self)

    _clock_type: ClockType

    @property
    def clock_type(self) -> ClockType:
        """The kind of clock."""
        return self._clock_type

    def now(self) -> Time:
        """Return the time now."""
        steady = self._clock_type == ClockType.STEADY_TIME
        return Time(nanoseconds=time.monotonic_ns() if steady else time.time_ns(), clock_type=self._clock_type)

    def __repr__(self) -> str:
        return f"Clock(clock_type={self._clock_type.name})"


class ROSClock(Clock):
    """A node's clock."""

    def __new__(cls) -> Self:
        """Make a clock of ROS time."""
        return super().__new__(cls, clock_type=ClockType.ROS_TIME)

    @property
    def ros_time_is_active(self) -> bool:
        """Whether the time is simulated: never here."""
        return False
