"""Check a topic's full name."""

from rclpy._names import validate_full_topic_name as validate_full_topic_name  # noqa: PLC0414  (re-export)
