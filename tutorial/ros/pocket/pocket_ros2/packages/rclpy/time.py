"""Points in time."""

from __future__ import annotations

from enum import IntEnum
from functools import total_ordering
from typing import Any, Self

from builtin_interfaces.msg import Time as TimeMessage
from rclpy import _rclpy_pybind11
from rclpy.clock_type import ClockType
from rclpy.constants import S_TO_NS
from rclpy.duration import Duration


@total_ordering
class Time:  # noqa: PLW1641  (rclpy's has no hash either)
    """A point in time, in whole nanoseconds since the epoch of its clock.

    Args:
        seconds: the time [s]; not negative.
        nanoseconds: added to ``seconds`` [ns]; not negative.
        clock_type: the kind of clock; times from different kinds of clocks cannot be compared.

    Raises:
        ValueError: an argument is negative.
        OverflowError: the time is 2^63 ns or more.
    """

    def __init__(
        self, *, seconds: float = 0, nanoseconds: float = 0, clock_type: IntEnum = ClockType.SYSTEM_TIME
    ) -> None:
        if not isinstance(clock_type, (ClockType, _rclpy_pybind11.ClockType)):
            raise TypeError("Clock type must be a ClockType enum")
        for name, value in (("Seconds", seconds), ("Nanoseconds", nanoseconds)):
            if value < 0:
                raise ValueError(f"{name} value must not be negative")
        self._nanoseconds = int(seconds * S_TO_NS) + int(nanoseconds)
        self._clock_type = _rclpy_pybind11.ClockType(clock_type)
        if self._nanoseconds >= 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")

    @property
    def nanoseconds(self) -> int:
        """The time [ns]."""
        return self._nanoseconds

    @property
    def clock_type(self) -> _rclpy_pybind11.ClockType:
        """The kind of clock that measured the time."""
        return self._clock_type

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Return the whole seconds [s] and the remainder [ns]."""
        return divmod(self._nanoseconds, S_TO_NS)

    def to_msg(self) -> TimeMessage:
        """Return the time as a ``builtin_interfaces.msg.Time``."""
        sec, nanosec = self.seconds_nanoseconds()
        return TimeMessage(sec=sec, nanosec=nanosec)

    @classmethod
    def from_msg(cls, msg: TimeMessage, clock_type: ClockType = ClockType.ROS_TIME) -> Self:
        """Create a time from a ``builtin_interfaces.msg.Time``."""
        if not isinstance(msg, TimeMessage):
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self._nanoseconds}, clock_type={self._clock_type.name})"

    def __add__(self, other: Any) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return Time(nanoseconds=self._nanoseconds + other.nanoseconds, clock_type=self._clock_type)
        except OverflowError as error:
            raise OverflowError("Addition leads to overflow in C storage.") from error

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            return Duration(nanoseconds=self._nanoseconds - self._comparable(other, "subtract"))
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return Time(nanoseconds=self._nanoseconds - other.nanoseconds, clock_type=self._clock_type)
        except ValueError as error:
            raise ValueError("Subtraction leads to negative time.") from error

    def __eq__(self, other: object) -> bool:
        return self._nanoseconds == self._comparable(other) if isinstance(other, Time) else NotImplemented

    def __lt__(self, other: Any) -> bool:
        return self._nanoseconds < self._comparable(other) if isinstance(other, Time) else NotImplemented

    def _comparable(self, other: Time, what: str = "compare") -> int:
        """Return the nanoseconds of another time, or raise TypeError if its clock type is different."""
        if self._clock_type != other._clock_type:
            raise TypeError(f"Can't {what} times with different clock types")
        return other._nanoseconds
