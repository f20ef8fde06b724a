"""The output of ``ros2 topic`` and ``ros2 node`` as text, with a real rclpy or the pocket's."""
