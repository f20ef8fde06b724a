"""Check a topic's name as a program gives it."""

from rclpy._names import validate_topic_name

__all__ = ["validate_topic_name"]
