"""Where rclpy keeps its logging; see :mod:`rclpy.logging`."""
