"""A ROS domain of one's own, so that runs side by side don't hear each other."""

from tutorial.ros.domains import FIRST, LAST, reserved_domain

__all__ = ["FIRST", "LAST", "reserved_domain"]
