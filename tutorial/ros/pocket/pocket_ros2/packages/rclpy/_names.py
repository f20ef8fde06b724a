"""The naming rules of rcl and rmw, with their error messages."""

import json
import re
from collections.abc import Callable
from pathlib import Path

from rclpy.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidServiceNameException,
    InvalidTopicNameException,
)

Rules = list[list[list[str]]]
"""Lists of patterns that match invalid names. Each pattern has an error message, and its group 1 marks the position of
the error. In the first list with a match, the pattern that matches earliest in the name determines the message."""

RULES: dict[str, Rules] = json.loads(Path(__file__).with_name("name_rules.json").read_text(encoding="utf-8"))
NODE_NAME, TOPIC_NAME, FULL_TOPIC_NAME, NAMESPACE = RULES.values()


def problem(rules: Rules, name: str) -> tuple[str, int] | None:
    """Return the error message for a name and the index of the error, or None if the name is valid."""
    for group in rules:
        matches = ((re.search(pattern, name, re.DOTALL), text) for pattern, text in group)
        if found := [(match.start(1), text) for match, text in matches if match]:
            index, text = min(found, key=lambda place: place[0])
            return text, index
    return None


def _valid(rules: Rules, name: str, error: Callable[[str, str, int], Exception]) -> bool:
    if found := problem(rules, name):
        raise error(name, *found)
    return True


def validate_node_name(node_name: str) -> bool:
    """Return True if a node's name, without its namespace, is valid; otherwise raise InvalidNodeNameException."""
    return _valid(NODE_NAME, node_name, InvalidNodeNameException)


def validate_namespace(namespace: str) -> bool:
    """Return True if a node's namespace is valid; otherwise raise InvalidNamespaceException."""
    return namespace == "/" or _valid(NAMESPACE, namespace, InvalidNamespaceException)


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True if a topic's relative, absolute or private name is valid.

    Args:
        name: the topic's name.
        is_service: whether this is the name of a service; the same rules apply.

    Raises:
        InvalidTopicNameException: the name breaks the naming rules.
        InvalidServiceNameException: the name of a service breaks the naming rules.
    """
    return _valid(TOPIC_NAME, name, InvalidServiceNameException if is_service else InvalidTopicNameException)


def validate_full_topic_name(name: str, *, is_service: bool = False) -> bool:
    """Return True if a topic's full name is valid; see :func:`validate_topic_name` for arguments and errors."""
    return _valid(FULL_TOPIC_NAME, name, InvalidServiceNameException if is_service else InvalidTopicNameException)


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Expand the name that a node uses for a topic into the topic's full name.

    Args:
        topic_name: relative to the namespace (``"joy"``), absolute (``"/joy"``) or private to the node (``"~/joy"``).
        node_name: name of the node that uses the topic.
        node_namespace: the node's absolute namespace, such as ``"/"`` or ``"/Tank"``.

    Raises:
        ValueError: a name or the namespace breaks the naming rules.
    """
    for kind, name, rules in (("topic name", topic_name, TOPIC_NAME), ("node name", node_name, NODE_NAME)):
        if found := problem(rules, name):
            raise ValueError(f"{kind} '{name}' is invalid: {found[0]}")
    if node_namespace != "/" and (found := problem(NAMESPACE, node_namespace)):
        raise ValueError(f"node namespace '{node_namespace}' is invalid: {found[0]}")
    inside = node_namespace.rstrip("/")
    values = {"{node}": node_name, "{ns}": node_namespace, "{namespace}": node_namespace}
    full_name = f"{inside}/{node_name}{topic_name[1:]}" if topic_name.startswith("~") else topic_name
    for substitution in re.findall(r"\{\w*\}", full_name):
        if substitution not in values:
            raise ValueError(f"topic name '{topic_name}' is invalid: unknown substitution: {substitution}")
        full_name = full_name.replace(substitution, values[substitution])
    return full_name if full_name.startswith("/") else f"{inside}/{full_name}"
