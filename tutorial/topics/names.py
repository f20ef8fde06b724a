"""Names of nodes and topics, as ROS 2 has them."""

from __future__ import annotations

__all__ = ["EVERY_NODE_HAS", "full_name", "is_hidden"]

EVERY_NODE_HAS = ("/rosout", "/parameter_events")
"""Topics that are there wherever there is a node."""


def full_name(name: str, namespace: str) -> str:
    """Put a node's name and its namespace together."""
    return f"{namespace.rstrip('/')}/{name}"


def is_hidden(name: str) -> bool:
    """Whether a node or a topic is left out of what ``ros2`` shows: a part of its name begins with an underscore."""
    return any(part.startswith("_") for part in name.split("/"))
