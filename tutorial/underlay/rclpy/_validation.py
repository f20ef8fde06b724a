"""The rules for names: those of rmw and rcl, with their wording.

Each function returns None for a valid name, else what is wrong and at which index.
"""

from __future__ import annotations

import re

__all__ = ["Problem", "full_topic_name", "namespace", "node_name", "topic_name"]

Problem = tuple[str, int] | None
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


def node_name(name: str) -> Problem:
    """Check a node's name, without namespace."""
    return ("node name must not be empty", 0) if not name else _first_broken(NODE_NAME_RULES, name)


def topic_name(name: str) -> Problem:
    """Check a topic's name as given to a node: relative, absolute or private (``~/x``)."""
    return ("topic name must not be empty string", 0) if not name else _first_broken(TOPIC_NAME_RULES, name)


def full_topic_name(name: str) -> Problem:
    """Check a topic's full name."""
    return _absolute("topic name", name) or _first_broken(_absolute_rules("topic name", 255 - 8), name)


def namespace(name: str) -> Problem:
    """Check a node's namespace."""
    if name == "/":
        return None
    return _absolute("namespace", name) or _first_broken(_absolute_rules("namespace", 245), name)


def _absolute(kind: str, name: str) -> Problem:
    if not name:
        return f"{kind} must not be empty", 0
    return None if name.startswith("/") else (f"{kind} must be absolute, it must lead with a '/'", 0)


def _absolute_rules(kind: str, longest: int) -> list[Rule]:
    return [
        (
            r"(?P<here>/)$",
            f"{kind} must not end with a '/'" + (", unless only a '/'" if kind == "namespace" else ""),
        ),
        (
            r"(?P<here>[^A-Za-z0-9_/])",
            f"{kind} must not contain characters other than alphanumerics, '_', or '/'",
        ),
        (r"/(?P<here>/)", f"{kind} must not contain repeated '/'"),
        (r"/(?P<here>[0-9])", f"{kind} must not have a token that starts with a number"),
        (rf"^.{{{longest}}}(?P<here>.)", f"{kind} should not exceed '{longest}'"),
    ]


def _first_broken(rules: list[Rule], name: str) -> Problem:
    for pattern, text in rules:
        if found := re.search(pattern, name, re.DOTALL):
            return text, found.start("here") if found.start("here") >= 0 else found.start()
    return None
