"""The commands ``tank node``: what ``ros2 node`` prints."""

# ruff: noqa: PLC0415 - rclpy takes a moment, and help is to come at once

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tutorial.commands.asking import asks
from tutorial.commands.terminal import say

if TYPE_CHECKING:
    from tutorial.ros.node_thread import MeteredNode

__all__ = ["node"]

SAME_NAME = (
    "WARNING: Be aware that there are nodes in the graph that share an exact name, "
    "which can have unintended side effects."
)


@click.group(short_help="List the nodes, or look at one, as ros2 node does.")
def node() -> None:
    """Look at nodes, as ros2 node does."""


@node.command("list")
@asks
async def list_nodes(asker: MeteredNode) -> None:
    """List the nodes there are, in all programs."""
    from tutorial.ros.topics import node_names, wait_for_graph
    from tutorial.ros.topics.names import escape_name

    await wait_for_graph(asker)
    names = node_names(asker)
    if len(set(names)) < len(names):
        say(f"{SAME_NAME}\n", err=True)
    say("".join(f"{escape_name(name)}\n" for name in names))


@node.command()
@click.argument("node_name")
@asks
async def info(asker: MeteredNode, node_name: str) -> None:
    """Say what a node publishes, subscribes to and offers. NODE_NAME is its full name, such as /simulation."""
    from tutorial.ros.topics import node_info, node_names, wait_for_graph

    await wait_for_graph(asker, lambda: node_name in node_names(asker))
    count = node_names(asker).count(node_name)
    if count > 1:
        say(
            f'There are {count} nodes in the graph with the exact name "{node_name}". '
            "You are seeing information about only one of them.\n",
            err=True,
        )
    say(node_info(asker, node_name))
