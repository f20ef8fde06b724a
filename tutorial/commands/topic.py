"""The commands ``tank topic`` and ``tank node``, which print what ``ros2 topic`` and ``ros2 node`` print."""

# ruff: noqa: PLC0415 - rclpy is slow to import, and help must be fast

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tutorial.commands.asking import query
from tutorial.commands.options import Finite
from tutorial.system.printing import print_text, print_texts

if TYPE_CHECKING:
    from tutorial.ros.node_thread import MeteredNode

SAME_NAME = (
    "WARNING: Be aware that there are nodes in the graph that share an exact name, "
    "which can have unintended side effects."
)


@click.group(short_help="List and inspect topics, and publish on them, as ros2 topic does.")
def topic() -> None:
    """List and inspect topics, and publish on them, as ros2 topic does."""


@topic.command("list")
@click.option("-t", "--show-types", is_flag=True, help="Show the topics' types.")
@query
async def list_topics(node: MeteredNode, show_types: bool) -> None:
    """List the topics."""
    from tutorial.ros.topics.listing import topic_list

    print_text(await topic_list(node, show_types))


@topic.command()
@click.argument("topic_name")
@click.option("-v", "--verbose", is_flag=True, help="Show the nodes and their quality of service.")
@query
async def info(node: MeteredNode, topic_name: str, verbose: bool) -> None:
    """Show a topic's type, and how many publishers and subscriptions it has."""
    from tutorial.ros.topics.listing import topic_info

    print_text(await topic_info(node, topic_name, verbose))


@topic.command()
@click.argument("topic_name")
@click.argument("message_type", required=False)
@click.option("--once", is_flag=True, help="Exit after the first message.")
@click.option("--field", metavar="FIELD", help="Show only this field, such as position or header.stamp.")
@click.option("--no-arr", is_flag=True, help="Print only the type and length of arrays.")
@query
async def echo(
    node: MeteredNode, topic_name: str, message_type: str | None, once: bool, field: str | None, no_arr: bool
) -> None:
    """Print the messages on a topic as they arrive, until Ctrl-C.

    With MESSAGE_TYPE, subscribe even if nobody publishes on the topic yet, or if it has several types.
    """
    from tutorial.ros.topics.listening import topic_echo

    await print_texts(topic_echo(node, topic_name, message_type, once=once, field=field, no_arr=no_arr))


@topic.command()
@click.argument("topic_name")
@click.option("-s", "--use-sim-time", is_flag=True, help="Measure in simulated time, from /clock.")
@query
async def hz(node: MeteredNode, topic_name: str) -> None:
    """Measure the message rate of a topic, until Ctrl-C."""
    from tutorial.ros.topics.listening import topic_hz

    await print_texts(topic_hz(node, topic_name))


@topic.command()
@click.argument("topic_name")
@click.argument("message_type")
@click.argument("values", default="{}")
@click.option("-r", "--rate", type=Finite(min=0, min_open=True), default=1.0, show_default=True, help="Rate [Hz].")
@click.option("-1", "--once", is_flag=True, help="Wait for a subscription, publish once, and exit.")
@query
async def pub(node: MeteredNode, topic_name: str, message_type: str, values: str, rate: float, once: bool) -> None:
    """Publish a message. VALUES are the message's fields in YAML: '{header: auto, axes: [0.0, 0.5]}'.

    As with ros2, a header of 'auto' and a stamp of 'now' are filled in with the time of publication, and the type
    can be abbreviated: sensor_msgs/Joy.
    """
    from tutorial.ros.topics.populate import populated
    from tutorial.ros.topics.publishing import topic_pub

    await print_texts(topic_pub(node, topic_name, populated(message_type, values), rate, once))


@click.group(short_help="List the nodes, as ros2 node does.")
def node() -> None:
    """Inspect nodes, as ros2 node does."""


@node.command("list")
@query
async def list_nodes(asker: MeteredNode) -> None:
    """List the nodes of all programs."""
    from tutorial.ros.topics.graph import wait_for_graph
    from tutorial.ros.topics.listing import node_names
    from tutorial.ros.topics.names import escape_name

    await wait_for_graph(asker)
    names = node_names(asker)
    if len(set(names)) < len(names):
        print_text(f"{SAME_NAME}\n", err=True)
    print_text("".join(f"{escape_name(name)}\n" for name in names))
