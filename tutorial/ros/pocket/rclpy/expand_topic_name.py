"""From a topic's name as a program gives it to its full name."""

from rclpy._names import expand_topic_name as expand_topic_name  # noqa: PLC0414  (programs find it here)
