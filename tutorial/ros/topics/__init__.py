"""What ``ros2 topic`` and ``ros2 node`` print, as text, for whichever rclpy is in use."""

from tutorial.ros.topics.listening import topic_echo, topic_hz
from tutorial.ros.topics.listing import topic_find, topic_info, topic_list, topic_type
from tutorial.ros.topics.nodes import node_info, node_names
from tutorial.ros.topics.publishing import topic_pub
from tutorial.ros.topics.settling import settled

__all__ = [
    "node_info",
    "node_names",
    "settled",
    "topic_echo",
    "topic_find",
    "topic_hz",
    "topic_info",
    "topic_list",
    "topic_pub",
    "topic_type",
]
