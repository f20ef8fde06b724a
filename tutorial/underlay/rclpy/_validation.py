"""The rules for names: those of rmw and rcl, with their wording."""

from __future__ import annotations

import re

from rclpy.exceptions import InvalidNamespaceException, InvalidNodeNameException, InvalidTopicNameException

__all__ = ["validate_full_topic_name", "validate_namespace", "validate_node_name", "validate_topic_name"]

Problem = tuple[str, int] | None
"""What is wrong with a name, and at which index."""

_Invalid = type[InvalidNamespaceException | InvalidNodeNameException | InvalidTopicNameException]
Rule = tuple[str, str]
"""A pattern that must not be found, and what to say. The index is where the group ``here`` begins."""

NODE_NAME_RULES: list[Rule] = [
    (r"(?P<here>[^A-Za-z0-9_])", "node name must not contain characters other than alphanumerics or '_'"),
    (r"^(?P<here>[0-9])", "node name must not start with a number"),
    (r"^.{255}(?P<here>.)", "node name length should not exceed '255'"),
]
TOPIC_NAME_RULES: list[Rule] = [
    (r"(?P<here>/)$", "topic name must not end with a forward slash"),
    (
        r"(?P<here>[^A-Za-z0-9_~{}/])",
        "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'",
    ),
    (r"(?:^|/)(?P<here>[0-9])", "topic name token must not start with a number"),
    (r".(?P<here>~)", "topic name must not have tilde '~' unless it is the first character"),
    (r"^~(?P<here>[^/])", "topic name must not have a tilde '~' that is not followed by a forward slash '/'"),
    (
        r"\{[^}]*(?P<here>\{)|^[^{]*(?P<stray>\})",
        "topic name must not have unmatched (unbalanced) curly braces '{}'",
    ),
    (r"/(?P<here>/)", "topic name must not contain repeated '/'"),
]


def validate_node_name(node_name: str) -> bool:
    """Return True if a node's name, without namespace, is valid, else raise InvalidNodeNameException."""
    problem = _first_broken(NODE_NAME_RULES, node_name) if node_name else ("node name must not be empty", 0)
    return _refuse(InvalidNodeNameException, node_name, problem)


def validate_namespace(namespace: str) -> bool:
    """Return True if a node's namespace is valid, else raise InvalidNamespaceException."""
    problem = None if namespace == "/" else _absolute_problem("namespace", namespace, 245)
    return _refuse(InvalidNamespaceException, namespace, problem)


def validate_topic_name(topic_name: str) -> bool:
    """Return True if a topic's name as given to a node (relative, absolute or private) is valid.

    Raises:
        InvalidTopicNameException: it isn't; the text points at the place.
    """
    problem = _first_broken(TOPIC_NAME_RULES, topic_name) if topic_name else ("topic name must not be empty string", 0)
    return _refuse(InvalidTopicNameException, topic_name, problem)


def validate_full_topic_name(topic_name: str) -> bool:
    """Return True if a topic's full name is valid, else raise InvalidTopicNameException."""
    return _refuse(InvalidTopicNameException, topic_name, _absolute_problem("topic name", topic_name, 255 - 8))


def _refuse(exception: _Invalid, name: str, problem: Problem) -> bool:
    if problem:
        raise exception(name, *problem)
    return True


def _absolute_problem(kind: str, name: str, longest: int) -> Problem:
    if not name:
        return f"{kind} must not be empty", 0
    if not name.startswith("/"):
        return f"{kind} must be absolute, it must lead with a '/'", 0
    only = ", unless only a '/'" if kind == "namespace" else ""
    rules = [
        (r"(?P<here>/)$", f"{kind} must not end with a '/'{only}"),
        (r"(?P<here>[^A-Za-z0-9_/])", f"{kind} must not contain characters other than alphanumerics, '_', or '/'"),
        (r"/(?P<here>/)", f"{kind} must not contain repeated '/'"),
        (r"/(?P<here>[0-9])", f"{kind} must not have a token that starts with a number"),
        (rf"^.{{{longest}}}(?P<here>.)", f"{kind} should not exceed '{longest}'"),
    ]
    return _first_broken(rules, name)


def _first_broken(rules: list[Rule], name: str) -> Problem:
    for pattern, text in rules:
        if found := re.search(pattern, name, re.DOTALL):
            return text, found.start("here") if found.start("here") >= 0 else found.start()
    return None
