"""Spans of time."""

from __future__ import annotations

from functools import total_ordering
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from builtin_interfaces.msg import Duration as DurationMessage

__all__ = ["S_TO_NS", "Duration", "Infinite"]

S_TO_NS = 1_000_000_000
INT64_MAX = 2**63 - 1


@total_ordering
class Duration:
    """A span of time, kept in whole nanoseconds.

    Args:
        seconds: [s], may be negative or have a fraction.
        nanoseconds: [ns], added to it.
    """

    def __init__(self, *, seconds: float = 0, nanoseconds: int = 0) -> None:
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if not -INT64_MAX - 1 <= total <= INT64_MAX:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")
        self._nanoseconds = total

    @property
    def nanoseconds(self) -> int:
        """The span [ns]."""
        return self._nanoseconds

    def to_msg(self) -> DurationMessage:
        """Return the span as a ``builtin_interfaces.msg.Duration``."""
        from builtin_interfaces.msg import Duration as DurationMessage  # noqa: PLC0415

        sec, nanosec = divmod(self._nanoseconds, S_TO_NS)
        return DurationMessage(sec=sec, nanosec=nanosec)

    @classmethod
    def from_msg(cls, msg: DurationMessage) -> Self:
        """Make a span of a ``builtin_interfaces.msg.Duration``."""
        return cls(nanoseconds=msg.sec * S_TO_NS + msg.nanosec)

    def __str__(self) -> str:
        return f"{self._nanoseconds} nanoseconds"

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self._nanoseconds})"

    def __eq__(self, other: object) -> bool:
        return self._nanoseconds == other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __lt__(self, other: Any) -> bool:
        return self._nanoseconds < other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._nanoseconds)


Infinite = Duration(nanoseconds=INT64_MAX)
