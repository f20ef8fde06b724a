"""The connection to ROS 2: the choice of rclpy, a node on its own thread, and the output of ``ros2`` commands."""
