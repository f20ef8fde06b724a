"""What meets ROS 2: which rclpy is in use, a node on a thread of its own, and what ``ros2`` prints."""
