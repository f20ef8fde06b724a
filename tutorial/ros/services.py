"""List and call services, as ``ros2 service list``, ``type`` and ``call`` do. Requires a real ROS 2.

The node must be spinning on its own thread (`tutorial.ros.node_thread.NodeThread`). These functions print nothing.
"""

import asyncio
import time
from collections.abc import AsyncGenerator, Callable, Iterator
from contextlib import contextmanager
from math import inf
from typing import Any

from rclpy.node import Node

from tutorial.errors import TutorialError
from tutorial.ros.backend import need_real_ros
from tutorial.ros.topics.graph import DISCOVERY_TIMEOUT, wait_for_graph
from tutorial.ros.topics.names import escape_name, is_hidden, service_class
from tutorial.ros.topics.populate import populated_request

LOOK_EVERY = 0.02  # [s] between checks for a service or a response
SETTLE = 0.2  # [s] within which a service usually discovers a new client, even on a busy machine


def services_with_types(node: Node) -> dict[str, list[str]]:
    """Return the types of each visible service, sorted by service name."""
    return {name: types for name, types in sorted(node.get_service_names_and_types()) if not is_hidden(name)}


async def service_list(node: Node, show_types: bool = False) -> str:
    """Wait until the graph is known, then list the services, like ``ros2 service list``.

    Args:
        node: the node that queries the graph; must be spinning on another thread.
        show_types: whether to add each service's type, as ``-t`` does.

    Returns:
        One line for each service.

    Raises:
        TutorialError: this process uses the pocket ROS 2.
    """
    need_real_ros("A service")
    await wait_for_graph(node)
    lines = (
        f"{escape_name(name)} [{', '.join(map(escape_name, types))}]\n" if show_types else f"{escape_name(name)}\n"
        for name, types in services_with_types(node).items()
    )
    return "".join(lines)


async def service_type(node: Node, service: str) -> str:
    """Wait briefly for a service to appear, then return its types, one per line, like ``ros2 service type``.

    Args:
        node: the node that queries the graph; must be spinning on another thread.
        service: the service's full name.

    Raises:
        TutorialError: there is no such service, or this process uses the pocket ROS 2.
    """
    need_real_ros("A service")
    await wait_for_graph(node, lambda: service in services_with_types(node))
    types = services_with_types(node).get(service)
    if types is None:
        raise TutorialError(f"Unknown service '{escape_name(service)}'")
    return "".join(f"{escape_name(name)}\n" for name in types)


async def service_call(
    node: Node, service: str, type_name: str, values: str = "{}", timeout: float = inf
) -> AsyncGenerator[str, None]:
    """Call a service, like ``ros2 service call``. If the service is not available yet, wait for it.

    Args:
        node: the node that calls the service; must be spinning on another thread.
        service: the service's name.
        type_name: the service's type, such as ``"std_srvs/srv/Trigger"``.
        values: the fields of the request in YAML.
        timeout: the maximum wait for the service, and then for its response [s].

    Yields:
        The text that ``ros2 service call`` prints, in parts.

    Raises:
        TutorialError: the type or a value is invalid (the error text is the same as in ``ros2``), the timeout expires,
            or this process uses the pocket ROS 2.
    """
    need_real_ros("A service")
    kind = service_class(type_name)
    request = populated_request(kind, values)
    with client(node, kind, service) as made:
        if not await is_ready(made, DISCOVERY_TIMEOUT):
            yield "waiting for service to become available...\n"
            if not await is_ready(made, timeout):
                raise TutorialError(f"No service '{escape_name(service)}' has appeared within {timeout:g} s")
        yield f"requester: making request: {request!r}\n\n"
        yield f"response:\n{await response_to(made, request, timeout)!r}\n\n"


@contextmanager
def client(node: Node, kind: Any, service: str) -> Iterator[Any]:
    """Create a client for a service, and destroy it at the end of the ``with`` block.

    Args:
        node: the node that calls the service.
        kind: the class of the service type.
        service: the service's name.
    """
    made = node.create_client(kind, service)
    try:
        yield made
    finally:
        node.destroy_client(made)


async def is_ready(made: Any, timeout: float) -> bool:
    """Wait until a client has found its service, and give the service time to find the client.

    A service cannot respond to a client that it has not discovered yet, and ROS 2 does not resend the response.

    Returns:
        Whether the service was found within the timeout [s].
    """
    found = await _until(made.service_is_ready, timeout)
    await asyncio.sleep(SETTLE if found else 0.0)
    return found


async def response_to(made: Any, request: Any, timeout: float = inf) -> Any:
    """Send a request through a client, and wait for the response.

    Raises:
        TutorialError: no response arrives within the timeout [s].
    """
    future = made.call_async(request)
    if not await _until(future.done, timeout):
        raise TutorialError(f"The service '{escape_name(made.srv_name)}' did not respond within {timeout:g} s")
    return future.result()


async def _until(condition: Callable[[], bool], timeout: float) -> bool:
    """Wait until a condition holds; return False if the timeout [s] expires first."""
    deadline = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > deadline:
            return False
        await asyncio.sleep(LOOK_EVERY)
    return True
