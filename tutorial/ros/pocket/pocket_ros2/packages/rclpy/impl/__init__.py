"""The package that contains rclpy's logging; see :mod:`rclpy.logging`."""
