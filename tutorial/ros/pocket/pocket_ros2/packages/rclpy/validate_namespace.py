"""Check a node's namespace."""

from rclpy._names import validate_namespace as validate_namespace  # noqa: PLC0414  (re-export)
