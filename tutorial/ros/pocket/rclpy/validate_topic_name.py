"""Check a topic's name as a program gives it."""

from rclpy._names import validate_topic_name as validate_topic_name  # noqa: PLC0414  (programs find it here)

TOPIC_SEPARATOR_STRING = "/"
