"""Names of nodes, topics and message types, as ROS 2 has them, and what other programs have in their place.

ROS 2 checks the names that its own programs use. A program that is DDS alone may call a topic ``//x``, and a node or a
type whatever it likes.
"""

# ruff: noqa: PLC0415 - `tank bag info` works without rclpy

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from tutorial.errors import TutorialError, printable

if TYPE_CHECKING:
    from rclpy.node import Node

LONGEST_NAME = 255
"""Characters of a name in ROS 2."""

EVERY_NODE_HAS = ("/rosout", "/parameter_events")
"""Topics that are there wherever there is a node."""


def full_name(name: str, namespace: str) -> str:
    """Put a node's name and its namespace together."""
    return f"{namespace.rstrip('/')}/{name}"


def escape_name(name: str) -> str:
    """Return a name as it may be printed: no more of it than ROS 2's longest, and what is not visible as escapes.

    Args:
        name: of a node, a topic or a type, from any program.
    """
    more = len(name) - LONGEST_NAME
    return printable(name[:LONGEST_NAME]) + (f"... and {more:,} more characters" if more > 0 else "")


def is_valid_topic(name: str) -> bool:
    """Whether a topic's full name keeps the rules of ROS 2, which answers no question about any other."""
    from rclpy.exceptions import NameValidationException
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        return bool(validate_full_topic_name(name))
    except (NameValidationException, ValueError, TypeError):  # the last two: half a character
        return False


def full_topic(node: Node, topic: str) -> str:
    """Return a topic's full name as a node has it: absolute, and remapped.

    Args:
        node: that asks.
        topic: its name as a user types it, such as ``"joy"`` or ``"/joy"``.

    Raises:
        TutorialError: it breaks the rules for names; the text is that of ROS 2.
    """
    from rclpy.exceptions import NameValidationException
    from rclpy.expand_topic_name import expand_topic_name

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
        type_name: such as ``"sensor_msgs/msg/Joy"``, or the short form ``"sensor_msgs/Joy"``; ROS 2 accepts both.

    Raises:
        TutorialError: there is none.
    """
    found = None
    try:
        package, *kind, name = type_name.split("/")
        if kind in ([], ["msg"]) and _has_messages(package):
            found = getattr(import_module(f"{package}.msg"), name)
    except (ValueError, TypeError, ImportError, AttributeError):
        pass
    if not is_message(found):
        raise TutorialError(f"The message type '{escape_name(type_name)}' is invalid")
    return found


def _has_messages(package: str) -> bool:
    """Whether a package has messages. It is not imported to find out: that runs code, and the name may be anyone's."""
    spec = find_spec(package) if package.isidentifier() else None
    if spec is None or spec.submodule_search_locations is None:
        return False
    places = spec.submodule_search_locations
    return any(finder.find_spec(f"{package}.msg", places) is not None for finder in sys.meta_path)
