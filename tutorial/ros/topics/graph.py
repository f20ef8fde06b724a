"""Waiting until the node graph is known, so that what is said about it is complete."""

import asyncio
import logging
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import islice
from math import inf

from rclpy.node import Node
from rclpy.utilities import get_rmw_implementation_identifier

from tutorial.ros.node_thread import NodeThread
from tutorial.ros.topics.endpoints import publishers_on, subscriptions_on
from tutorial.ros.topics.names import EVERY_NODE_HAS, full_name

_log = logging.getLogger(__name__)

READ_EVERY = 0.1  # [s] between two looks at the graph
QUIET_READS = 5  # that have to agree before the graph counts as known
PATIENT_READS = 30  # on a real rclpy, which does not tell whether more is on its way: see `_reads`
LOOKED_INTO = 50  # topics, of however many there are, whose publishers and subscriptions are looked at
PATIENCE = 8.0  # [s]; Fast DDS says again who its nodes are every 3 s, beginning after 1 s
DISCOVERY_TIMEOUT = 2.0  # [s] that a node or topic that is asked for may take to turn up
TIMEOUT_ON_FAST_DDS = 6.0  # [s]
NAMELESS = "_NODE_NAME_UNKNOWN_"  # whose name is still on its way


async def wait_for_graph(node: Node, wanted: Callable[[], object] = lambda: True, patience: float = PATIENCE) -> bool:
    """Wait until all who were discovered have told what they have, and what is known has stopped changing.

    Other nodes of this process are there for certain, so they are waited for, too: Fast DDS takes seconds to meet them.
    If that was in vain, a warning says so.

    Args:
        node: that asks; its thread must spin.
        wanted: whether what is asked for is there; if it is not, the wait goes on a little longer.
        patience: how long to wait at most [s].

    Returns:
        Whether the graph is known.
    """
    began = time.monotonic()
    timeout = TIMEOUT_ON_FAST_DDS if _is_fast_dds() else DISCOVERY_TIMEOUT
    seen: tuple[tuple[str, ...], ...] = ()
    agreeing = 0  # looks in a row
    while True:
        before, seen = seen, _snapshot(node)
        agreeing = agreeing + 1 if seen == before else 0
        done, waited = agreeing >= _reads(node, seen), time.monotonic() - began
        if done and (waited >= timeout or (_has_met_its_own(node) and wanted())):
            return True
        if waited >= patience:
            _log.warning("nodes still come and go: what is said of them may be incomplete")
            return False
        await asyncio.sleep(READ_EVERY)


def _reads(node: Node, seen: tuple[tuple[str, ...], ...]) -> float:
    """How many looks have to agree.

    The pocket ROS 2 knows who has yet to tell. On a real rclpy a name may be missing, which a program that is DDS alone
    never tells, or Fast DDS may have found nobody.
    """
    if hasattr(node.context, "graph"):
        return QUIET_READS if node.context.graph.is_complete() else inf
    alone = _is_fast_dds() and seen[:1] == ((full_name(node.get_name(), node.get_namespace()),),)
    return PATIENT_READS if alone or any(NAMELESS in names for names in seen) else QUIET_READS


def _has_met_its_own(node: Node) -> bool:
    """Whether a node knows of all other nodes of its process that are in its domain."""
    met = {full_name(*each) for each in node.get_node_names_and_namespaces()}
    domain = node.context.get_domain_id()
    ours = (each for each in tuple(NodeThread.alive) if each.node.context.get_domain_id() == domain)
    return met.issuperset(each.full_name for each in ours)


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
