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


@click.group(short_help="List the nodes, as ros2 node does.")
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
