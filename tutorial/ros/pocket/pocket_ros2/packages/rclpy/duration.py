"""Durations."""

from functools import total_ordering
from typing import Any, Self

from builtin_interfaces.msg import Duration as DurationMessage
from rclpy.constants import S_TO_NS


@total_ordering
class Duration:  # noqa: PLW1641  (rclpy's has no hash either)
    """A duration in whole nanoseconds.

    Args:
        seconds: the duration [s]; can be negative or fractional.
        nanoseconds: an amount to add to ``seconds`` [ns].

    Raises:
        OverflowError: the duration exceeds 2^63 ns.
    """

    def __init__(self, *, seconds: float = 0, nanoseconds: float = 0) -> None:
        self._nanoseconds = int(seconds * S_TO_NS) + int(nanoseconds)
        if not -(2**63) <= self._nanoseconds < 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")

    @property
    def nanoseconds(self) -> int:
        """The duration [ns]."""
        return self._nanoseconds

    def to_msg(self) -> DurationMessage:
        """Return the duration as a ``builtin_interfaces.msg.Duration``."""
        sec, nanosec = divmod(self._nanoseconds, S_TO_NS)
        return DurationMessage(sec=sec, nanosec=nanosec)

    @classmethod
    def from_msg(cls, msg: DurationMessage) -> Self:
        """Create a duration from a ``builtin_interfaces.msg.Duration``."""
        if not isinstance(msg, DurationMessage):
            raise TypeError("Must pass a builtin_interfaces.msg.Duration object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)

    def __str__(self) -> str:
        return "Infinite" if self == Infinite else f"{self._nanoseconds} nanoseconds"

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self._nanoseconds})"

    def __eq__(self, other: object) -> bool:
        return self._nanoseconds == other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __lt__(self, other: Any) -> bool:
        return self._nanoseconds < other._nanoseconds if isinstance(other, Duration) else NotImplemented


Infinite = Duration(nanoseconds=2**63 - 1)
