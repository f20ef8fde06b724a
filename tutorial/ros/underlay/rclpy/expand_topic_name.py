"""From a topic's name as a program gives it to its full name."""

from rclpy._names import expand_topic_name

__all__ = ["expand_topic_name"]
