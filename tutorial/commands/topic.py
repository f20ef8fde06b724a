"""The commands ``tank topic``: what ``ros2 topic`` prints."""

# ruff: noqa: PLC0415 - rclpy takes a moment, and help is to come at once

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tutorial.commands.asking import asks, meet
from tutorial.commands.streams import echo, hz, pub
from tutorial.commands.terminal import say

if TYPE_CHECKING:
    from tutorial.ros.node_thread import MeteredNode

__all__ = ["topic"]

hidden_option = click.option("--include-hidden-topics", "include_hidden", is_flag=True, help="Show hidden topics, too.")


@click.group(short_help="List topics, look at one, or publish on it, as ros2 topic does.")
def topic() -> None:
    """Look at topics and publish on them, as ros2 topic does."""


@topic.command("list")
@click.option("-t", "--show-types", is_flag=True, help="Show the topics' types.")
@click.option("-c", "--count-topics", is_flag=True, help="Print only how many there are.")
@hidden_option
@click.option("-v", "--verbose", is_flag=True, help="Show how many publish and subscribe.")
@asks
async def list_topics(node: MeteredNode, count_topics: bool, include_hidden: bool, **how: bool) -> None:
    """List the topics there are."""
    from tutorial.ros.topics import topic_list

    await meet(node)
    if count_topics:
        say(f"{topic_list(node, include_hidden=include_hidden).count(chr(10))}\n")
    else:
        say(topic_list(node, include_hidden=include_hidden, **how))


@topic.command()
@click.argument("topic_name")
@click.option("-v", "--verbose", is_flag=True, help="Show the nodes, and their quality of service.")
@asks
async def info(node: MeteredNode, topic_name: str, verbose: bool) -> None:
    """Say what type a topic has, and who publishes and subscribes."""
    from tutorial.ros.topics import topic_info, topic_type

    await meet(node, lambda: topic_type(node, topic_name, include_hidden=True))
    say(topic_info(node, topic_name, verbose))


@topic.command("type")
@click.argument("topic_name")
@hidden_option
@asks
async def type_(node: MeteredNode, topic_name: str, include_hidden: bool) -> int:
    """Print a topic's type; the exit status is 1 when there is no such topic."""
    from tutorial.ros.topics import topic_type

    await meet(node, lambda: topic_type(node, topic_name, include_hidden))
    text = topic_type(node, topic_name, include_hidden)
    say(text)
    return 0 if text else 1


@topic.command()
@click.argument("topic_type")
@click.option("-c", "--count-topics", is_flag=True, help="Print only how many there are.")
@hidden_option
@asks
async def find(node: MeteredNode, topic_type: str, count_topics: bool, include_hidden: bool) -> None:
    """List the topics of a type, such as sensor_msgs/msg/Joy."""
    from tutorial.ros.topics import topic_find

    await meet(node)
    text = topic_find(node, topic_type, include_hidden)
    say(f"{text.count(chr(10))}\n" if count_topics else text)


for command in (echo, hz, pub):
    topic.add_command(command)
