"""The quality of service that ``ros2 topic`` asks for and offers."""

from __future__ import annotations

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from tutorial.ros.topics.endpoints import publishers_on

__all__ = ["compromises", "offered_qos", "reader_qos", "requested_qos"]

SENSOR_DEPTH = 5  # of rclpy's qos_profile_sensor_data, which ros2 begins with
DEFAULT_DEPTH = 10  # of rclpy's default profile


def reader_qos(node: Node, topic: str) -> QoSProfile:
    """Choose what a subscription can ask for so that all publishers of a topic fit it, as ``ros2`` does.

    Args:
        node: that asks.
        topic: its full name.
    """
    offered = [info.qos_profile for info in publishers_on(node, topic)]
    reliable = bool(offered) and all(qos.reliability == ReliabilityPolicy.RELIABLE for qos in offered)
    lasting = bool(offered) and all(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in offered)
    return _profile(
        SENSOR_DEPTH, "reliable" if reliable else "best_effort", "transient_local" if lasting else "volatile"
    )


def compromises(node: Node, topic: str) -> str:
    """Say where `reader_qos` asks for less than some publishers offer, in the lines of ``ros2 topic echo``."""
    offered = [info.qos_profile for info in publishers_on(node, topic)]
    reliable = sum(qos.reliability == ReliabilityPolicy.RELIABLE for qos in offered)
    lasting = sum(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in offered)
    text = ""
    if 0 < reliable < len(offered):
        text += _compromise("QoSReliabilityPolicy", "RELIABLE", "BEST_EFFORT")
    if 0 < lasting < len(offered):
        text += _compromise("QoSDurabilityPolicy", "TRANSIENT_LOCAL", "VOLATILE")
    return text


def requested_qos(reliability: str | None, durability: str | None) -> QoSProfile | None:
    """Return what ``--qos-reliability`` and ``--qos-durability`` ask for; None when neither is given.

    Args:
        reliability: such as ``"best_effort"``.
        durability: such as ``"transient_local"``.
    """
    if reliability is None and durability is None:
        return None
    return _profile(SENSOR_DEPTH, reliability or "best_effort", durability or "volatile")


def offered_qos(reliability: str | None, durability: str | None) -> QoSProfile:
    """Return what ``ros2 topic pub`` offers, with its ``--qos-reliability`` and ``--qos-durability``."""
    return _profile(DEFAULT_DEPTH, reliability or "reliable", durability or "volatile")


def _profile(depth: int, reliability: str, durability: str) -> QoSProfile:
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy[reliability.upper()],
        durability=DurabilityPolicy[durability.upper()],
    )


def _compromise(policy: str, wish: str, instead: str) -> str:
    return (
        f"Some, but not all, publishers are offering {policy}.{wish}. "
        f"Falling back to {policy}.{instead} as it will connect to all publishers\n"
    )
