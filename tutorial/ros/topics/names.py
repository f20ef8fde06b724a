"""Handle the names of nodes, topics and message types, including names that ROS 2 does not allow.

ROS 2 checks the names that its own programs use. A program that uses DDS without ROS 2 can name a topic ``//x`` and
give a node or a type any name.
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
"""Maximum length of a node name in ROS 2 [characters]; the maximum for a topic name is 8 less."""

EVERY_NODE_HAS = ("/rosout", "/parameter_events")
"""The topics that every node has."""


def full_name(name: str, namespace: str) -> str:
    """Join a node's name and its namespace."""
    return f"{namespace.rstrip('/')}/{name}"


def escape_name(name: str) -> str:
    """Return a name that is safe to print: truncated to ROS 2's maximum length, with invisible characters escaped.

    Args:
        name: the name of a node, a topic or a type, from any program.
    """
    more = len(name) - LONGEST_NAME
    return printable(name[:LONGEST_NAME]) + (f"... and {more:,} more characters" if more > 0 else "")


def is_valid_topic(name: str) -> bool:
    """Return whether a topic's full name follows ROS 2's naming rules. ROS 2 rejects queries for any other name."""
    from rclpy.exceptions import NameValidationException
    from rclpy.validate_full_topic_name import validate_full_topic_name

    try:
        return bool(validate_full_topic_name(name))
    except (NameValidationException, ValueError, TypeError):  # the last two are raised for a lone surrogate
        return False


def full_topic(node: Node, topic: str) -> str:
    """Return a topic's full name as a node resolves it: absolute and remapped.

    Args:
        node: the node.
        topic: the topic's name as a user writes it, such as ``"joy"`` or ``"/joy"``.

    Raises:
        TutorialError: the name breaks the naming rules; the error text is the same as in ROS 2.
    """
    from rclpy.exceptions import NameValidationException
    from rclpy.expand_topic_name import expand_topic_name

    try:
        expand_topic_name(topic, node.get_name(), node.get_namespace())
        return str(node.resolve_topic_name(topic))
    except (NameValidationException, RuntimeError, ValueError) as error:
        raise TutorialError(str(error)) from error


def is_hidden(name: str) -> bool:
    """Return whether ``ros2`` hides a node or a topic because a part of its name starts with an underscore."""
    return any(part.startswith("_") for part in name.split("/"))


def is_message(value: Any) -> bool:
    """Return whether a value is a message or a message class."""
    return hasattr(value, "get_fields_and_field_types")


def message_class(type_name: str) -> Any:
    """Return the class of a message type.

    Args:
        type_name: the type's name, such as ``"sensor_msgs/msg/Joy"``, or its short form, such as
            ``"sensor_msgs/Joy"``; ROS 2 accepts both forms.

    Raises:
        TutorialError: there is no such type.
    """
    found = _interface(type_name, "msg")
    if not is_message(found):
        raise TutorialError(f"The message type '{escape_name(type_name)}' is invalid")
    return found


def service_class(type_name: str) -> Any:
    """Return the class of a service type.

    Args:
        type_name: the type's name, such as ``"std_srvs/srv/Trigger"``, or its short form, such as
            ``"std_srvs/Trigger"``; ROS 2 accepts both forms.

    Raises:
        TutorialError: there is no such type, or it is not a service type; the error text is the same as in ``ros2``.
    """
    found = _interface(type_name, "srv") or _interface(type_name, "msg")
    if found is None:
        raise TutorialError("The passed service type is invalid")
    if not hasattr(found, "Request"):
        raise TutorialError("The passed type is not a service")
    return found


def _interface(type_name: str, part: str) -> Any:
    """Return the class with a name such as ``package/msg/Name`` or ``package/Name``; None if there is no such class."""
    try:
        package, *kind, name = type_name.split("/")
        if kind in ([], [part]) and _has_part(package, part):
            return getattr(import_module(f"{package}.{part}"), name)
    except (ValueError, TypeError, ImportError, AttributeError):
        pass
    return None


def _has_part(package: str, part: str) -> bool:
    """Return whether a package has a subpackage such as ``msg``, without running the package's code by importing it."""
    spec = find_spec(package) if package.isidentifier() else None
    if spec is None or spec.submodule_search_locations is None:
        return False
    places = spec.submodule_search_locations
    return any(finder.find_spec(f"{package}.{part}", places) is not None for finder in sys.meta_path)
