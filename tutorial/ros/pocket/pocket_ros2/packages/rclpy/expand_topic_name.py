"""Expand a topic's name to its full name."""

from rclpy._names import expand_topic_name as expand_topic_name  # noqa: PLC0414  (re-export)
