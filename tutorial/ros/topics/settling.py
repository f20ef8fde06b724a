"""Waiting until the node graph holds still, so that what is said about it is complete."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import islice

from rclpy.node import Node
from rclpy.utilities import get_rmw_implementation_identifier

from tutorial.ros.topics.endpoints import publishers_on, subscriptions_on
from tutorial.ros.topics.names import EVERY_NODE_HAS, full_name

__all__ = ["met", "settled"]

READ_EVERY = 0.1  # [s] between two looks at the graph
QUIET_READS = 5  # that have to agree before the graph counts as settled
PATIENT_READS = 30  # where more may be on its way: see `_lacks_something`
LOOKED_INTO = 50  # topics, of however many there are, whose publishers and subscriptions are looked at
PATIENCE = 5.0  # [s] for it to settle
SHY = 2.0  # [s] that a node or topic that is asked for may take to turn up
SHY_ON_FAST_DDS = 6.0  # [s]
NAMELESS = "_NODE_NAME_UNKNOWN_"  # whose name is still on its way


async def settled(node: Node, patience: float = PATIENCE) -> bool:
    """Wait until the node graph has stopped changing, so that what is said about it is complete.

    Args:
        node: that asks; its thread must spin.
        patience: how long to wait at most [s].

    Returns:
        Whether the graph has settled.
    """
    deadline = time.monotonic() + patience
    seen: tuple[tuple[str, ...], ...] = ()
    agreeing = 0  # looks in a row
    while True:
        before, seen = seen, _snapshot(node)
        enough = PATIENT_READS if _lacks_something(node, seen) else QUIET_READS
        agreeing = agreeing + 1 if seen == before else 0
        if agreeing >= enough or time.monotonic() >= deadline:
            return agreeing >= enough
        await asyncio.sleep(READ_EVERY)


async def met(node: Node, wanted: Callable[[], object]) -> bool:
    """As `settled`, but what is asked for and not there yet is waited for a little longer.

    Args:
        node: that asks; its thread must spin.
        wanted: whether it is there.

    Returns:
        Whether the graph has settled.
    """
    deadline = time.monotonic() + (SHY_ON_FAST_DDS if _is_fast_dds() else SHY)
    while True:
        done = await settled(node)
        if wanted() or time.monotonic() >= deadline:
            return done


def _lacks_something(node: Node, seen: tuple[tuple[str, ...], ...]) -> bool:
    """Whether a node's name is missing, which a program that is DDS alone never tells, or Fast DDS has found nobody."""
    if any(NAMELESS in names for names in seen):
        return True
    return _is_fast_dds() and seen[:1] == ((full_name(node.get_name(), node.get_namespace()),),)


def _is_fast_dds() -> bool:
    return "fastrtps" in get_rmw_implementation_identifier()


def _snapshot(node: Node) -> tuple[tuple[str, ...], ...]:
    """All nodes, and all topics with those who publish and subscribe, where that is of interest."""
    snapshot: list[tuple[str, ...]] = []
    topics: list[tuple[str, list[str]]] = []
    with suppress(RuntimeError, UnicodeDecodeError):  # a real one names no node while any has an empty name
        snapshot.append(tuple(sorted(full_name(*names) for names in node.get_node_names_and_namespaces())))
    with suppress(UnicodeDecodeError):  # nor any topic while one of the names is no text
        topics = node.get_topic_names_and_types()
    snapshot += [(topic, *types) for topic, types in topics]
    for topic in islice((topic for topic, _ in topics if topic not in EVERY_NODE_HAS), LOOKED_INTO):
        infos = (*publishers_on(node, topic), *subscriptions_on(node, topic))
        snapshot.append(tuple(sorted(info.node_name for info in infos)))
    return tuple(snapshot)
