"""The commands ``tank node``: what ``ros2 node`` prints."""

# ruff: noqa: PLC0415 - rclpy takes a moment, and help is to come at once

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tutorial.commands.asking import asks, meet
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
@click.option("-a", "--all", "include_hidden", is_flag=True, help="List hidden nodes, too.")
@click.option("-c", "--count-nodes", is_flag=True, help="Print only how many there are.")
@asks
async def list_nodes(asker: MeteredNode, include_hidden: bool, count_nodes: bool) -> None:
    """List the nodes there are, in all programs."""
    from tutorial.ros.topics import node_names
    from tutorial.ros.topics.names import shown

    await meet(asker)
    names = node_names(asker, include_hidden)
    if count_nodes:
        say(f"{len(names)}\n")
        return
    if len(set(names)) < len(names):
        say(f"{SAME_NAME}\n", err=True)
    say("".join(f"{shown(name)}\n" for name in names))


@node.command()
@click.argument("node_name")
@click.option("--include-hidden", is_flag=True, help="Show hidden topics and services, too.")
@asks
async def info(asker: MeteredNode, node_name: str, include_hidden: bool) -> None:
    """Say what a node publishes, subscribes to and offers. NODE_NAME is its full name, such as /simulation."""
    from tutorial.ros.topics import node_info, node_names

    await meet(asker, lambda: node_name in node_names(asker, include_hidden))
    count = node_names(asker, include_hidden).count(node_name)
    if count > 1:
        say(
            f'There are {count} nodes in the graph with the exact name "{node_name}". '
            "You are seeing information about only one of them.\n",
            err=True,
        )
    say(node_info(asker, node_name, include_hidden))
