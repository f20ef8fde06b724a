"""The tank tutorial: learn ROS 2 by building a tank, step by step, in the browser.

Importing this package makes ``rclpy`` importable: the real one if ROS 2 is installed, otherwise the one in
``pocket_ros2``.
"""

from tutorial.ros.backend import promise, ros_backend, use_real_ros

__all__ = ["ros_backend", "use_real_ros"]

promise()
