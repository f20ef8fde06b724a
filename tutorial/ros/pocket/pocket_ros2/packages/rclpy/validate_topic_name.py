"""Check a topic's name before it is expanded."""

from rclpy._names import validate_topic_name as validate_topic_name  # noqa: PLC0414  (re-export)

TOPIC_SEPARATOR_STRING = "/"
