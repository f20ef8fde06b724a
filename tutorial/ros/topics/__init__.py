"""The output of ``ros2 topic`` and ``ros2 node`` as text, with whichever rclpy is in use."""
