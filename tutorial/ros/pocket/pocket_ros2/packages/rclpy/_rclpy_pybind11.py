"""What rclpy gets from its C++ part, above all exceptions; programs catch them by this module's name."""

from enum import Enum, IntEnum


class ClockType(IntEnum):
    """What a time says of its clock: as rclpy.clock_type.ClockType, but printed by name."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3

    __str__ = Enum.__str__


class RCLError(RuntimeError):
    """Something went wrong in the layers below rclpy."""


class NodeNameNonExistentError(RCLError):
    """There is no node of this name."""


class InvalidHandle(RuntimeError):  # noqa: N818  (rclpy's name)
    """A publisher, subscription, timer or node was used after it had been destroyed."""

    def __init__(self, text: str = "cannot use Destroyable because destruction was requested") -> None:
        super().__init__(text)


class UnknownROSArgsError(RuntimeError):
    """There is an argument after ``--ros-args`` that ROS 2 does not know."""


class Destroyable:
    """Base of what can be destroyed, after which its methods raise InvalidHandle."""

    _destroyed = False

    def _require_handle(self) -> None:
        if self._destroyed:
            raise InvalidHandle
