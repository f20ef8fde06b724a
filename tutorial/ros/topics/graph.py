"""Wait until the node graph is known, so that listings are complete."""

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

READ_EVERY = 0.1  # [s] between reads of the graph
QUIET_READS = 5  # consecutive identical reads before the graph counts as known
PATIENT_READS = 30  # used instead of QUIET_READS if the real rclpy may still discover more nodes: see `_reads`
LOOKED_INTO = 50  # maximum number of topics whose publishers and subscriptions are read
TIMEOUT = 8.0  # [s]; Fast DDS announces its nodes after 1 s, and again every 3 s
DISCOVERY_TIMEOUT = 2.0  # [s] how long a requested node or topic can take to appear
TIMEOUT_ON_FAST_DDS = 6.0  # [s] DISCOVERY_TIMEOUT for Fast DDS
NAMELESS = "_NODE_NAME_UNKNOWN_"  # placeholder until a node's name arrives


async def wait_for_graph(node: Node, wanted: Callable[[], object] = lambda: True, timeout: float = TIMEOUT) -> bool:
    """Wait until every discovered participant has announced its entities and the graph has stopped changing.

    Also wait for the other nodes of this process: they certainly exist, but Fast DDS takes seconds to discover them. If
    the wait times out, log a warning.

    Args:
        node: the node that queries the graph; must be spinning on another thread.
        wanted: returns whether the requested entity has been discovered; if not, `wait_for_graph` waits a bit longer.
        timeout: maximum wait [s].

    Returns:
        Whether the graph is known.
    """
    began = time.monotonic()
    discovery = TIMEOUT_ON_FAST_DDS if _is_fast_dds() else DISCOVERY_TIMEOUT
    seen: tuple[tuple[str, ...], ...] = ()
    agreeing = 0  # consecutive identical reads
    while True:
        before, seen = seen, _snapshot(node)
        agreeing = agreeing + 1 if seen == before else 0
        done, waited = agreeing >= _reads(node, seen), time.monotonic() - began
        if done and (waited >= discovery or (_has_met_its_own(node) and wanted())):
            return True
        if waited >= timeout:
            _log.warning("nodes are still joining and leaving: this output may be incomplete")
            return False
        await asyncio.sleep(READ_EVERY)


def _reads(node: Node, seen: tuple[tuple[str, ...], ...]) -> float:
    """Return how many consecutive reads of the graph must give the same result.

    The pocket ROS 2 knows which participants have not announced all their entities. With the real rclpy, a node's name
    may be missing because a program that uses DDS without ROS 2 never announces one. Also, Fast DDS may not have
    discovered any other program yet.
    """
    if hasattr(node.context, "graph"):
        return QUIET_READS if node.context.graph.is_complete() else inf
    alone = _is_fast_dds() and seen[:1] == ((full_name(node.get_name(), node.get_namespace()),),)
    return PATIENT_READS if alone or any(NAMELESS in names for names in seen) else QUIET_READS


def _has_met_its_own(node: Node) -> bool:
    """Return whether a node has discovered all other nodes of its process and domain."""
    met = {full_name(*each) for each in node.get_node_names_and_namespaces()}
    domain = node.context.get_domain_id()
    ours = (each for each in tuple(NodeThread.alive) if each.node.context.get_domain_id() == domain)
    return met.issuperset(each.full_name for each in ours)


def _is_fast_dds() -> bool:
    return "fastrtps" in get_rmw_implementation_identifier()


def _snapshot(node: Node) -> tuple[tuple[str, ...], ...]:
    """Return all nodes, topics and services and, for some topics, the nodes that publish or subscribe to them."""
    snapshot: list[tuple[str, ...]] = []
    topics: list[tuple[str, list[str]]] = []
    with suppress(RuntimeError, UnicodeDecodeError):  # the real rclpy lists no nodes while any node has an empty name
        snapshot.append(tuple(sorted(full_name(*names) for names in node.get_node_names_and_namespaces())))
    with suppress(UnicodeDecodeError):  # the real rclpy lists no topics while any name is not valid UTF-8
        topics = node.get_topic_names_and_types()
    snapshot += [(topic, *types) for topic, types in topics]
    services = getattr(node, "get_service_names_and_types", list)  # the pocket ROS 2 has no services
    with suppress(UnicodeDecodeError):
        snapshot += [(service, *types) for service, types in services()]
    for topic in islice((topic for topic, _ in topics if topic not in EVERY_NODE_HAS), LOOKED_INTO):
        infos = (*publishers_on(node, topic), *subscriptions_on(node, topic))
        snapshot.append(tuple(sorted(info.node_name for info in infos)))
    return tuple(snapshot)
