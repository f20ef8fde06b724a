"""The output of ``ros2 topic`` and ``ros2 node`` as text, produced with the real rclpy or the pocket ROS 2."""
