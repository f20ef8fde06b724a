"""List nodes and topics, and describe a topic, as ``ros2 node list``, ``topic list`` and ``topic info`` do.

The node must be spinning on its own thread (`tutorial.ros.node_thread.NodeThread`). These functions print nothing.
Names are escaped with `escape_name`, whereas ``ros2`` prints names unchanged.
"""

from rclpy.duration import Duration, Infinite
from rclpy.node import Node
from rclpy.qos import HistoryPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from tutorial.errors import TutorialError
from tutorial.ros.topics.endpoints import publishers_on, subscriptions_on
from tutorial.ros.topics.graph import wait_for_graph
from tutorial.ros.topics.names import escape_name, full_name, is_hidden


def node_names(node: Node) -> list[str]:
    """Return the sorted full names of all nodes except hidden ones; a name appears once for each node that has it.

    Args:
        node: the node that queries the graph.
    """
    found = node.get_node_names_and_namespaces()
    return sorted(full_name(name, space) for name, space in found if not name.startswith("_"))


def topics_with_types(node: Node, include_hidden: bool = False) -> dict[str, list[str]]:
    """Return the types of each topic, sorted by topic name.

    Args:
        node: the node that queries the graph.
        include_hidden: include topics whose names have a part that starts with an underscore.
    """
    found = sorted(node.get_topic_names_and_types())
    return {topic: types for topic, types in found if include_hidden or not is_hidden(topic)}


async def node_list(node: Node) -> str:
    """Wait until the graph is known, then list the nodes that are not hidden, like ``ros2 node list``.

    Args:
        node: the node that queries the graph; must be spinning on another thread.

    Returns:
        One line for each node.
    """
    await wait_for_graph(node)
    return "".join(f"{escape_name(name)}\n" for name in node_names(node))


async def topic_list(node: Node, show_types: bool = False) -> str:
    """Wait until the graph is known, then list the topics that are not hidden, like ``ros2 topic list``.

    Args:
        node: the node that queries the graph; must be spinning on another thread.
        show_types: add each topic's type, as ``-t`` does.

    Returns:
        One line for each topic.
    """
    await wait_for_graph(node)
    lines = (
        f"{escape_name(topic)} [{', '.join(map(escape_name, types))}]\n" if show_types else f"{escape_name(topic)}\n"
        for topic, types in topics_with_types(node).items()
    )
    return "".join(lines)


async def topic_info(node: Node, topic: str, verbose: bool = False) -> str:
    """Wait briefly for a topic to appear, then describe its publishers and subscriptions, like ``ros2 topic info``.

    Args:
        node: the node that queries the graph; must be spinning on another thread.
        topic: the topic's full name.
        verbose: describe each publisher and subscription, including its QoS, as ``-v`` does.

    Raises:
        TutorialError: there is no such topic; the error text is the same as in ``ros2``.
    """
    await wait_for_graph(node, lambda: topic in topics_with_types(node, include_hidden=True))
    types = topics_with_types(node, include_hidden=True).get(topic)
    if types is None:
        raise TutorialError(f"Unknown topic '{escape_name(topic)}'")
    publishers, subscriptions = publishers_on(node, topic), subscriptions_on(node, topic)
    names = [escape_name(name) for name in types]
    parts = [f"Type: {names[0] if len(names) == 1 else names}", f"Publisher count: {len(publishers)}"]
    parts += [_endpoint_text(info) for info in publishers if verbose]
    parts += [f"Subscription count: {len(subscriptions)}"]
    parts += [_endpoint_text(info) for info in subscriptions if verbose]
    end = "\n\n" if verbose else "\n"
    return end.join(parts) + end


def _endpoint_text(info: TopicEndpointInfo) -> str:
    """Describe a publisher or subscription as ``ros2 topic info -v`` does."""
    qos = info.qos_profile
    depth = f" ({qos.depth})" if qos.history == HistoryPolicy.KEEP_LAST else ""
    return "\n".join(
        (
            f"Node name: {escape_name(info.node_name)}",
            f"Node namespace: {escape_name(info.node_namespace)}",
            f"Topic type: {escape_name(info.topic_type)}",
            f"Topic type hash: {info.topic_type_hash}",
            f"Endpoint type: {info.endpoint_type.name}",
            f"GID: {'.'.join(f'{byte:02x}' for byte in info.endpoint_gid)}",
            "QoS profile:",
            f"  Reliability: {qos.reliability.name}",
            f"  History (Depth): {qos.history.name}{depth}",
            f"  Durability: {qos.durability.name}",
            f"  Lifespan: {_duration_text(qos.lifespan)}",
            f"  Deadline: {_duration_text(qos.deadline)}",
            f"  Liveliness: {qos.liveliness.name}",
            f"  Liveliness lease duration: {_duration_text(qos.liveliness_lease_duration)}",
        )
    )


def _duration_text(duration: Duration) -> str:
    return "Infinite" if duration == Infinite else f"{duration.nanoseconds} nanoseconds"
