"""What ``ros2 topic`` prints - list, info, echo, hz - as text, for whichever rclpy is in use."""

from tutorial.topics.settling import settle, settled
from tutorial.topics.tools import topic_echo, topic_hz, topic_info, topic_list

__all__ = ["settle", "settled", "topic_echo", "topic_hz", "topic_info", "topic_list"]
