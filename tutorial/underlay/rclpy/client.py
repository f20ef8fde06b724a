"""Service clients: not in the embedded ROS 2."""

from rclpy.exceptions import NeedsRealROSError

raise NeedsRealROSError("rclpy.client")
