"""The package where rclpy keeps its logging; see :mod:`rclpy.logging`."""
