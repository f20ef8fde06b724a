"""What ``ros2 topic`` and ``ros2 node`` print, as text, for whichever rclpy is in use."""
