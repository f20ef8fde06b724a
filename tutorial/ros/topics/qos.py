"""The quality of service that ``ros2 topic`` asks for."""

from __future__ import annotations

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from tutorial.ros.topics.endpoints import publishers_on

__all__ = ["reader_qos"]

SENSOR_DEPTH = 5  # of rclpy's qos_profile_sensor_data, which ros2 begins with


def reader_qos(node: Node, topic: str) -> QoSProfile:
    """Choose what a subscription can ask for so that all publishers of a topic fit it, as ``ros2`` does.

    Args:
        node: that asks.
        topic: its full name.
    """
    offered = [info.qos_profile for info in publishers_on(node, topic)]
    reliable = bool(offered) and all(qos.reliability == ReliabilityPolicy.RELIABLE for qos in offered)
    lasting = bool(offered) and all(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in offered)
    return QoSProfile(
        depth=SENSOR_DEPTH,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if lasting else DurabilityPolicy.VOLATILE,
    )
