"""What ``ros2 topic`` and ``ros2 node`` print, as text, for whichever rclpy is in use."""

from tutorial.ros.topics.graph import wait_for_graph
from tutorial.ros.topics.listening import topic_echo, topic_hz
from tutorial.ros.topics.listing import node_names, topic_info, topic_list
from tutorial.ros.topics.publishing import topic_pub

__all__ = [
    "node_names",
    "topic_echo",
    "topic_hz",
    "topic_info",
    "topic_list",
    "topic_pub",
    "wait_for_graph",
]
