"""The tank tutorial: learn ROS 2 by building a tank, step by step, in the browser.

Importing this package promises an ``rclpy``: the real one where ROS 2 is installed, else that of the pocket
ROS 2, ``tutorial/ros/pocket``.
"""

from tutorial.ros.backend import promise, ros_backend

__all__ = ["ros_backend"]

promise()
