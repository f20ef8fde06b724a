"""Which nodes there are and what each does: ``ros2 node list`` and ``info``, as text.

The node that asks has a thread of its own, `tutorial.ros.node_thread.NodeThread`. Nothing here prints. Names stand in
the texts as `escape_name`: ``ros2`` has them as they come.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from importlib import import_module
from typing import Any

from rclpy.node import Node

from tutorial.errors import TutorialError, printable
from tutorial.ros.topics.names import escape_name, full_name, is_hidden

__all__ = ["node_info", "node_names"]

NamesAndTypes = Iterable[tuple[str, list[str]]]


def node_names(node: Node) -> list[str]:
    """Return the full names of the nodes there are, but for hidden ones, sorted; one that several have comes as often.

    Args:
        node: that asks.
    """
    found = node.get_node_names_and_namespaces()
    return sorted(full_name(name, space) for name, space in found if not name.startswith("_"))


def node_info(node: Node, name: str) -> str:
    """Say what a node subscribes to, publishes and offers, as ``ros2 node info``.

    Args:
        node: that asks.
        name: the full name of the node in question.

    Raises:
        TutorialError: there is no such node; the text is that of ``ros2``.
    """
    found = node.get_node_names_and_namespaces()
    named = [who for who in found if full_name(*who) == name and not who[0].startswith("_")]
    if not named:
        raise TutorialError(f"Unable to find node '{escape_name(name)}'")
    try:
        sections = _sections(node, named[0])
    except (RuntimeError, ValueError) as error:  # it has gone, or its name breaks the rules
        raise TutorialError(f"nothing can be said of node '{escape_name(name)}': {printable(str(error))}") from error
    return f"{escape_name(name)}\n" + "".join(_section(title, has) for title, has in sections.items())


def _sections(node: Node, who: tuple[str, str]) -> dict[str, NamesAndTypes]:
    """What a node has, by the title that it stands below; an rclpy without services or actions has none to tell of.

    Args:
        node: that asks.
        who: the node in question: its name, and its namespace.
    """
    actions: Any = None
    with suppress(ImportError):
        actions = import_module("rclpy.action")

    def asked(api: Any, question: str, *about: Any) -> NamesAndTypes:
        return getattr(api, question)(*about) if hasattr(api, question) else ()

    return {
        "Subscribers": node.get_subscriber_names_and_types_by_node(*who),
        "Publishers": node.get_publisher_names_and_types_by_node(*who),
        "Service Servers": asked(node, "get_service_names_and_types_by_node", *who),
        "Service Clients": asked(node, "get_client_names_and_types_by_node", *who),
        "Action Servers": asked(actions, "get_action_server_names_and_types_by_node", node, *who),
        "Action Clients": asked(actions, "get_action_client_names_and_types_by_node", node, *who),
    }


def _section(title: str, names_and_types: NamesAndTypes) -> str:
    """One section; an empty one has an empty line."""
    told = (item for item in names_and_types if not is_hidden(item[0]))
    lines = [f"    {escape_name(name)}: {', '.join(map(escape_name, types))}" for name, types in told]
    return "\n".join((f"  {title}:", *(lines or [""]))) + "\n"
