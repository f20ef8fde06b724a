"""Kinds of clocks."""

from enum import IntEnum


class ClockType(IntEnum):
    """The kind of clock that measures a time."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3
