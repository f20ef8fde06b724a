"""The commands ``tank topic echo``, ``hz`` and ``pub``, which go on: what those of ``ros2`` print."""

# ruff: noqa: PLC0415 - rclpy takes a moment, and help is to come at once

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from tutorial.commands.asking import ask, asks, meet, say_all
from tutorial.commands.options import Finite, Seconds
from tutorial.commands.terminal import say
from tutorial.errors import TutorialError

if TYPE_CHECKING:
    from tutorial.ros.node_thread import MeteredNode

__all__ = ["echo", "hz", "pub"]

RELIABILITIES = ("reliable", "best_effort", "system_default")
DURABILITIES = ("volatile", "transient_local", "system_default")


def qos_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command the two options for the quality of service that a learner meets."""
    reliability = click.option(
        "--qos-reliability", type=click.Choice(RELIABILITIES), help="Whether lost messages are sent again."
    )
    durability = click.option(
        "--qos-durability", type=click.Choice(DURABILITIES), help="Whether who comes late receives earlier messages."
    )
    return reliability(durability(command))


@click.command()
@click.argument("topic_name")
@click.argument("message_type", required=False)
@click.option("--once", is_flag=True, help="End after the first message.")
@click.option("--field", metavar="FIELD", help="Show only this field, such as position or header.stamp.")
@click.option("--csv", is_flag=True, help="Print a line with commas instead of YAML.")
@click.option("-f", "--full-length", is_flag=True, help="Print long arrays and strings in full.")
@click.option(
    "-l",
    "--truncate-length",
    type=click.IntRange(min=0),
    default=128,
    show_default=True,
    help="From which length on they are cut.",
)
@click.option("--no-arr", is_flag=True, help="Print of each array only what it is.")
@click.option("--timeout", type=Seconds(min=0, min_open=True), metavar="SECONDS", help="End after so long.")
@qos_options
@asks
async def echo(
    node: MeteredNode,
    *,
    topic_name: str,
    message_type: str | None,
    once: bool,
    full_length: bool,
    truncate_length: int,
    timeout: float | None,
    qos_reliability: str | None,
    qos_durability: str | None,
    **form: Any,
) -> None:
    """Print the messages of a topic as they come, until Ctrl-C."""
    from tutorial.ros.topics import topic_echo
    from tutorial.ros.topics.message_form import MessageForm
    from tutorial.ros.topics.populate import passed_class
    from tutorial.ros.topics.qos import requested_qos

    how = MessageForm(truncate_length=None if full_length else truncate_length, **form)
    kind = passed_class(message_type) if message_type else None
    qos = requested_qos(qos_reliability, qos_durability)
    topic = await _expected(node, topic_name, anyhow=kind is not None, compromise=qos is None)
    with suppress(TimeoutError):
        async with asyncio.timeout(timeout):
            await say_all(topic_echo(node, topic, count=1 if once else None, form=how, kind=kind, qos=qos))


@click.command()
@click.argument("topic_name")
@click.option(
    "-w", "--window", type=click.IntRange(min=1), default=10_000, show_default=True, help="Of how many messages."
)
@click.option("-s", "--use-sim-time", is_flag=True, help="By simulated time, from /clock.")
@asks
async def hz(node: MeteredNode, topic_name: str, window: int) -> None:
    """Measure how often messages come on a topic, until Ctrl-C."""
    from tutorial.ros.topics import topic_hz
    from tutorial.ros.topics.listening import type_of
    from tutorial.ros.topics.names import full_topic

    topic = full_topic(node, topic_name)
    await meet(node, lambda: type_of(node, topic))
    await say_all(topic_hz(node, topic, window=window))


@click.command()
@click.argument("topic_name")
@click.argument("message_type")
@click.argument("values", default="{}")
@click.option("-r", "--rate", type=Finite(min=0, min_open=True), default=1.0, show_default=True, help="How often [Hz].")
@click.option(
    "-p", "--print", "print_every", type=click.IntRange(min=0), default=1, metavar="N", help="Print every N-th message."
)
@click.option("-1", "--once", is_flag=True, help="Publish once, and end.")
@click.option("-t", "--times", type=click.IntRange(min=0), default=0, help="Publish so many times, and end.")
@click.option(
    "-w",
    "--wait-matching-subscriptions",
    "wait",
    type=click.IntRange(min=0),
    help="Wait for so many subscriptions; 1 by default with --once and --times, else 0.",
)
@click.option("-n", "--node-name", help="The name of the node that publishes.")
@qos_options
@click.pass_obj
def pub(ros_args: list[str], /, once: bool, times: int, node_name: str | None, **options: Any) -> int:
    """Publish a message. VALUES are its fields in YAML: '{axes: [0.0, 0.5]}'; a header may be auto, a time now."""
    if once and times:
        raise click.UsageError("argument -t/--times: not allowed with argument -1/--once")
    return ask(ros_args, partial(_pub, times=1 if once else times, **options), node_name)


async def _pub(
    node: MeteredNode,
    *,
    topic_name: str,
    message_type: str,
    values: str,
    times: int,
    wait: int | None,
    qos_reliability: str | None,
    qos_durability: str | None,
    **options: Any,
) -> None:
    from tutorial.ros.topics import topic_pub
    from tutorial.ros.topics.populate import passed_class, populated
    from tutorial.ros.topics.qos import offered_qos

    message, stamps = populated(passed_class(message_type), values)
    await meet(node)
    wait = int(times != 0) if wait is None else wait
    qos = offered_qos(qos_reliability, qos_durability)
    await say_all(topic_pub(node, topic_name, message, stamps, times=times, wait=wait, qos=qos, **options))


async def _expected(node: MeteredNode, topic_name: str, anyhow: bool, compromise: bool) -> str:
    """Meet those who are on a topic; return its full name.

    Args:
        node: that asks.
        topic_name: as the user typed it.
        anyhow: nobody need be there, for the type is known.
        compromise: say what the subscription does without, to fit all publishers.

    Raises:
        TutorialError: there is no such topic.
    """
    from tutorial.ros.topics.listening import NO_TYPE, not_published, type_of
    from tutorial.ros.topics.names import full_topic
    from tutorial.ros.topics.qos import compromises

    topic = full_topic(node, topic_name)
    await meet(node, lambda: anyhow or type_of(node, topic))
    if compromise:
        say(compromises(node, topic))
    if not anyhow and type_of(node, topic) is None:
        say(f"{not_published(topic_name)}\n")
        raise TutorialError(NO_TYPE)
    return topic
