"""Callback groups: not in the embedded ROS 2."""

from rclpy.exceptions import NeedsRealROSError

raise NeedsRealROSError("rclpy.callback_groups")
