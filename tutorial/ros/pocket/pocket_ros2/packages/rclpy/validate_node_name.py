"""Check a node's name."""

from rclpy._names import validate_node_name as validate_node_name  # noqa: PLC0414  (re-export)
