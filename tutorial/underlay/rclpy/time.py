"""Points in time."""

from __future__ import annotations

from functools import total_ordering
from typing import TYPE_CHECKING, Any, Self, overload

from rclpy.clock_type import ClockType
from rclpy.duration import INT64_MAX, S_TO_NS, Duration

if TYPE_CHECKING:
    from builtin_interfaces.msg import Time as TimeMessage

__all__ = ["Time"]


@total_ordering
class Time:
    """A point in time, kept in whole nanoseconds since its clock's beginning.

    Args:
        seconds: [s], not negative.
        nanoseconds: [ns], not negative, added to it.
        clock_type: the kind of clock; times of different kinds cannot be compared.
    """

    def __init__(
        self, *, seconds: float = 0, nanoseconds: int = 0, clock_type: ClockType = ClockType.SYSTEM_TIME
    ) -> None:
        if seconds < 0:
            raise ValueError("Seconds value must not be negative")
        if nanoseconds < 0:
            raise ValueError("Nanoseconds value must not be negative")
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if total > INT64_MAX:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self._nanoseconds = total
        self._clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        """The time [ns]."""
        return self._nanoseconds

    @property
    def clock_type(self) -> ClockType:
        """The kind of clock that measured it."""
        return self._clock_type

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Return whole seconds [s] and the rest [ns]."""
        return divmod(self._nanoseconds, S_TO_NS)

    def to_msg(self) -> TimeMessage:
        """Return the time as a ``builtin_interfaces.msg.Time``."""
        from builtin_interfaces.msg import Time as TimeMessage  # noqa: PLC0415

        sec, nanosec = self.seconds_nanoseconds()
        return TimeMessage(sec=sec, nanosec=nanosec)

    @classmethod
    def from_msg(cls, msg: TimeMessage, clock_type: ClockType = ClockType.ROS_TIME) -> Self:
        """Make a time of a ``builtin_interfaces.msg.Time``."""
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self._nanoseconds}, clock_type={self._clock_type.name})"

    def __add__(self, other: Any) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        return Time(nanoseconds=self._nanoseconds + other.nanoseconds, clock_type=self._clock_type)

    __radd__ = __add__

    @overload
    def __sub__(self, other: Time) -> Duration: ...
    @overload
    def __sub__(self, other: Duration) -> Time: ...
    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            self._require_same_clock(other, "subtract")
            return Duration(nanoseconds=self._nanoseconds - other._nanoseconds)
        if isinstance(other, Duration):
            return Time(nanoseconds=self._nanoseconds - other.nanoseconds, clock_type=self._clock_type)
        return NotImplemented

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Time):
            return NotImplemented
        self._require_same_clock(other, "compare")
        return self._nanoseconds == other._nanoseconds

    def __lt__(self, other: Any) -> bool:
        if not isinstance(other, Time):
            return NotImplemented
        self._require_same_clock(other, "compare")
        return self._nanoseconds < other._nanoseconds

    def __hash__(self) -> int:
        return hash(self._nanoseconds)

    def _require_same_clock(self, other: Time, what: str) -> None:
        if self._clock_type != other._clock_type:
            raise TypeError(f"Can't {what} times with different clock types")
