"""Waiting until the node graph holds still, so that what is said about it is complete."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Hashable

from rclpy.node import Node

from tutorial.ros.topics.names import EVERY_NODE_HAS, full_name

__all__ = ["met", "settle", "settled"]

READ_EVERY = 0.1  # [s] between two looks at the graph
QUIET_READS = 5  # that have to agree before the graph counts as settled
PATIENCE = 5.0  # [s] for it to settle
SHY = 2.0  # [s] that a node or topic that is asked for may take to turn up: Fast DDS is slower than Cyclone
NAMELESS = "_NODE_NAME_UNKNOWN_"  # whose name is still on its way


class _Settling:
    """Tells when the node graph has stopped changing, as one node sees it.

    Attributes:
        done: whether it has.
    """

    def __init__(self, node: Node, patience: float) -> None:
        self.done = False
        self._node = node
        self._deadline = time.monotonic() + patience
        self._seen: Hashable = None
        self._agreeing = 0

    def goes_on(self) -> bool:
        """Look once more, and say whether to look again: until all has been the same for a while, or time is over."""
        seen = _snapshot(self._node)
        is_complete = all(NAMELESS not in names for names in seen)  # every endpoint has its node's name
        self._agreeing = self._agreeing + 1 if is_complete and seen == self._seen else 0
        self._seen = seen
        self.done = self._agreeing >= QUIET_READS
        return not self.done and time.monotonic() < self._deadline


def settle(node: Node, patience: float = PATIENCE) -> bool:
    """Wait until the node graph has stopped changing, so that what is said about it is complete.

    It blocks the thread that it is called on. In a notebook take `settled`.

    Args:
        node: that asks; its thread must spin.
        patience: how long to wait at most [s].

    Returns:
        Whether the graph has settled.
    """
    settling = _Settling(node, patience)
    while settling.goes_on():
        time.sleep(READ_EVERY)
    return settling.done


async def settled(node: Node, patience: float = PATIENCE) -> bool:
    """As `settle`, but other things go on meanwhile."""
    settling = _Settling(node, patience)
    while settling.goes_on():
        await asyncio.sleep(READ_EVERY)
    return settling.done


async def met(node: Node, wanted: Callable[[], object]) -> bool:
    """As `settled`, but what is asked for and not there yet is waited for a little longer.

    Args:
        node: that asks; its thread must spin.
        wanted: whether it is there.

    Returns:
        Whether the graph has settled.
    """
    deadline = time.monotonic() + SHY
    while True:
        done = await settled(node)
        if wanted() or time.monotonic() >= deadline:
            return done


def _snapshot(node: Node) -> tuple[tuple[str, ...], ...]:
    """All nodes, and all topics with those who publish and subscribe, where that is of interest."""
    nodes = sorted(full_name(name, space) for name, space in node.get_node_names_and_namespaces())
    snapshot = [tuple(nodes)]
    for topic, types in node.get_topic_names_and_types():
        snapshot.append((topic, *types))
        if topic not in EVERY_NODE_HAS:
            infos = (*node.get_publishers_info_by_topic(topic), *node.get_subscriptions_info_by_topic(topic))
            snapshot.append(tuple(sorted(info.node_name for info in infos)))
    return tuple(snapshot)
