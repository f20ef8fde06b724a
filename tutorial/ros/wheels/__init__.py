"""The real rclpy that PyPI has as wheels, in a folder of its own outside the Python environment."""
