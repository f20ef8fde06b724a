"""The rules for names: those of rcl and rmw, with their wording, as tables."""

import re
from collections.abc import Callable

from rclpy.exceptions import InvalidNamespaceException, InvalidNodeNameException, InvalidTopicNameException

Rules = list[list[tuple[str, str]]]
"""Patterns that a name must not match, and what to say then; group 1 is at the place. They are in groups: of the first
group with a match, the match that comes first in the name counts."""

ONLY = "must not contain characters other than alphanumerics"
UNBALANCED = "topic name must not have unmatched (unbalanced) curly braces '{}'"

NODE_NAME: Rules = [
    [(r"\A()\Z", "node name must not be empty")],
    [(r"([^A-Za-z0-9_])", f"node name {ONLY} or '_'")],
    [(r"\A([0-9])", "node name must not start with a number")],
    [(r"\A.{254}(.).", "node name length should not exceed '255'")],
]
TOPIC_NAME: Rules = [
    [(r"\A()\Z", "topic name must not be empty string")],
    [(r"\A([0-9])", "topic name token must not start with a number")],
    [(r"(/)\Z", "topic name must not end with a forward slash")],
    [
        (r"\{([0-9])", "substitution name must not start with a number"),
        (r"\{[^{}]*?([^A-Za-z0-9_~}])", f"substitution name {ONLY} or '_'"),
        (r".(~)", "topic name must not have tilde '~' unless it is the first character"),
        (r"(?:\A|\})[^{}]*(\})", UNBALANCED),
        (r"([^A-Za-z0-9_/~{}])", f"topic name {ONLY}, '_', '~', '{{', or '}}'"),
    ],
    [(r"(\{)[^}]*\Z", UNBALANCED)],
    [
        (r"/([0-9])", "topic name token must not start with a number"),
        (r"\A~([^/]).", "topic name must not have a tilde '~' that is not followed by a forward slash '/'"),
    ],
]


def _absolute(kind: str, unless: str, too_long: tuple[str, str]) -> Rules:
    """Return the rules for what begins with a slash."""
    return [
        [(r"\A()\Z", f"{kind} must not be empty")],
        [(r"\A([^/])", f"{kind} must be absolute, it must lead with a '/'")],
        [(r"(/)\Z", f"{kind} must not end with a '/'{unless}")],
        [(r"([^A-Za-z0-9_/])", f"{kind} {ONLY}, '_', or '/'")],
        [
            (r"/(/)", f"{kind} must not contain repeated '/'"),
            (r"/([0-9])", f"{kind} must not have a token that starts with a number"),
        ],
        [too_long],
    ]


FULL_TOPIC_NAME = _absolute("topic name", "", (r"\A.{246}(.).", "topic length should not exceed '255U - 8U'"))
NAMESPACE = _absolute("namespace", ", unless only a '/'", (r"\A.{244}(.).", "namespace should not exceed '245'"))


def problem(rules: Rules, name: str) -> tuple[str, int] | None:
    """Return what is wrong with a name and at which index, None if nothing."""
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
    """Return True if a node's name, without namespace, is valid, else raise InvalidNodeNameException."""
    return _valid(NODE_NAME, node_name, InvalidNodeNameException)


def validate_namespace(namespace: str) -> bool:
    """Return True if a node's namespace is valid, else raise InvalidNamespaceException."""
    return namespace == "/" or _valid(NAMESPACE, namespace, InvalidNamespaceException)


def validate_topic_name(name: str) -> bool:
    """Return True if a topic's name is valid, whether relative, absolute or private, else raise
    InvalidTopicNameException."""
    return _valid(TOPIC_NAME, name, InvalidTopicNameException)


def validate_full_topic_name(name: str) -> bool:
    """Return True if a topic's full name is valid, else raise InvalidTopicNameException."""
    return _valid(FULL_TOPIC_NAME, name, InvalidTopicNameException)


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """Expand a topic's name for a node.

    Args:
        topic_name: relative to the namespace (``"joy"``), absolute (``"/joy"``) or private to the node (``"~/joy"``).
        node_name: of the node that uses it.
        node_namespace: of that node.

    Raises:
        ValueError: a name breaks the rules.
    """
    for kind, name, rules in (("topic", topic_name, TOPIC_NAME), ("node", node_name, NODE_NAME)):
        if found := problem(rules, name):
            raise ValueError(f"{kind} name '{name}' is invalid: {found[0]}")
    inside = node_namespace.rstrip("/")
    values = {"{node}": node_name, "{ns}": node_namespace, "{namespace}": node_namespace}
    full_name = f"{inside}/{node_name}{topic_name[1:]}" if topic_name.startswith("~") else topic_name
    for substitution in re.findall(r"\{\w*\}", full_name):
        if substitution not in values:
            raise ValueError(f"topic name '{topic_name}' is invalid: unknown substitution: {substitution}")
        full_name = full_name.replace(substitution, values[substitution])
    return full_name if full_name.startswith("/") else f"{inside}/{full_name}"
