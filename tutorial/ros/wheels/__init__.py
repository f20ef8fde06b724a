"""The real rclpy from PyPI's wheels, in a separate folder outside the Python environment."""
