"""From a topic's name as a program gives it to its full name."""

from __future__ import annotations

from rclpy._validation import validate_full_topic_name, validate_topic_name

__all__ = ["expand_topic_name"]


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Expand a topic's name for a node.

    Args:
        topic_name: relative to the namespace (``"joy"``), absolute (``"/joy"``) or private to the node (``"~/joy"``).
        node_name: of the node that uses it.
        node_namespace: of that node.

    Raises:
        InvalidTopicNameException: the name breaks the rules.
    """
    validate_topic_name(topic_name)
    inside = node_namespace.rstrip("/")
    full_name = (
        topic_name.replace("{node}", node_name).replace("{ns}", node_namespace).replace("{namespace}", node_namespace)
    )
    if full_name.startswith("~"):
        full_name = f"{inside}/{node_name}{full_name[1:]}"
    elif not full_name.startswith("/"):
        full_name = f"{inside}/{full_name}"
    validate_full_topic_name(full_name)
    return full_name
