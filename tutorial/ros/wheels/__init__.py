"""The real rclpy, installed from wheels on PyPI into a folder outside the Python environment."""
