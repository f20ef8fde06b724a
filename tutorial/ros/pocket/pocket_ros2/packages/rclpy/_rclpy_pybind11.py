"""Exceptions and types from rclpy's C++ module of the same name, which programs import to catch the exceptions."""

from enum import Enum, IntEnum


class ClockType(IntEnum):
    """The clock type of a time: like rclpy.clock_type.ClockType, but its members are printed as names."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3

    __str__ = Enum.__str__


class RCLError(RuntimeError):
    """An error in the layers below rclpy."""


class NodeNameNonExistentError(RCLError):
    """There is no node with this name."""


class InvalidHandle(RuntimeError):  # noqa: N818  (rclpy's name)
    """A publisher, subscription, timer or node was used after it had been destroyed."""

    def __init__(self, text: str = "cannot use Destroyable because destruction was requested") -> None:
        super().__init__(text)


class UnknownROSArgsError(RuntimeError):
    """An argument after ``--ros-args`` is unknown to ROS 2."""


class Destroyable:
    """Base class of objects that can be destroyed; a destroyed object's methods raise InvalidHandle."""

    _destroyed = False

    def _require_handle(self) -> None:
        if self._destroyed:
            raise InvalidHandle
