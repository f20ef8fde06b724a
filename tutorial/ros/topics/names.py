"""Names of nodes, topics and message types, as ROS 2 has them."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from rclpy.exceptions import NameValidationException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node

from tutorial.errors import TutorialError

__all__ = ["EVERY_NODE_HAS", "full_name", "full_topic", "is_hidden", "is_message", "message_class", "parted"]

EVERY_NODE_HAS = ("/rosout", "/parameter_events")
"""Topics that are there wherever there is a node."""


def full_name(name: str, namespace: str) -> str:
    """Put a node's name and its namespace together."""
    return f"{namespace.rstrip('/')}/{name}"


def parted(full_name: str) -> tuple[str, str]:
    """Part a node's full name into its name and its namespace."""
    namespace, _, name = full_name.rpartition("/")
    return name, namespace or "/"


def full_topic(node: Node, topic: str) -> str:
    """Return a topic's full name as a node has it: absolute, and remapped.

    Args:
        node: that asks.
        topic: its name as a user types it, such as ``"joy"`` or ``"/joy"``.

    Raises:
        TutorialError: it breaks the rules for names; the text is that of ROS 2.
    """
    try:
        expand_topic_name(topic, node.get_name(), node.get_namespace())
        return str(node.resolve_topic_name(topic))
    except (NameValidationException, RuntimeError, ValueError) as error:
        raise TutorialError(str(error)) from error


def is_hidden(name: str) -> bool:
    """Whether a node or a topic is left out of what ``ros2`` shows: a part of its name begins with an underscore."""
    return any(part.startswith("_") for part in name.split("/"))


def is_message(value: Any) -> bool:
    """Whether something is a message, or the class of messages."""
    return hasattr(value, "get_fields_and_field_types")


def message_class(type_name: str) -> Any:
    """Return the class of a message type.

    Args:
        type_name: such as ``"sensor_msgs/msg/Joy"``.

    Raises:
        TutorialError: there is none.
    """
    found = None
    try:
        package, kind, name = type_name.split("/")
        found = getattr(import_module(f"{package}.{kind}"), name)
    except (ValueError, TypeError, ImportError, AttributeError):
        pass
    if not is_message(found):
        raise TutorialError(f"The message type '{type_name}' is invalid")
    return found
