"""List, read and set the parameters of other nodes; return the text that ``ros2 param`` prints.

Requires a real ROS 2. The node that sends the requests must be spinning on its own thread
(`tutorial.ros.node_thread.NodeThread`). These functions print nothing.
"""

from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module
from typing import Any

import yaml
from rcl_interfaces.msg import Parameter, ParameterDescriptor
from rclpy import parameter
from rclpy.node import Node

from tutorial.errors import TutorialError
from tutorial.ros.backend import need_real_ros
from tutorial.ros.services import client, is_ready, response_to
from tutorial.ros.topics.graph import wait_for_graph
from tutorial.ros.topics.listing import node_names
from tutorial.ros.topics.names import escape_name

PATIENCE = 5.0  # [s] maximum time to wait for a node's services, as in ros2, and for each response
TRIES = 3  # number of unanswered requests before a node counts as unresponsive

NAMES = (
    *("not set", "boolean", "integer", "double", "string"),
    *("byte array", "boolean array", "integer array", "double array", "string array"),
)
"""The names of the parameter types, indexed by their numbers in rcl_interfaces/msg/ParameterType."""

LABELS = (
    *("Parameter not set.", "Boolean value is:", "Integer value is:", "Double value is:", "String value is:"),
    *("Byte values are:", "Boolean values are:", "Integer values are:", "Double values are:", "String values are:"),
)
"""The words printed before a value, indexed by the number of the value's type."""


async def param_list(node: Node, target: str | None = None) -> str:
    """List the parameters of a node, or of all nodes except hidden ones, like ``ros2 param list``.

    Args:
        node: a node that spins on another thread and sends the requests.
        target: the name of the node that has the parameters; None for all nodes.

    Raises:
        TutorialError: there is no such node, or this process uses the pocket ROS 2.
    """
    if target is not None:
        return _indented(await _names(node, await _find(node, target)))
    need_real_ros("Another node's parameter")
    await wait_for_graph(node)
    text = ""
    for found in sorted(set(node_names(node)), key=lambda name: name.rpartition("/")[::-1]):  # as in ros2
        try:
            names = await _names(node, found)
        except TutorialError as error:  # a node without services, such as one on the pocket ROS 2
            text += f"{error}\n"
        else:
            text += f"{escape_name(found)}:\n{_indented(names)}" if names else ""
    return text


async def param_get(node: Node, target: str, name: str) -> str:
    """Return the value of a parameter, like ``ros2 param get``.

    Args:
        node: a node that spins on another thread and sends the requests.
        target: the name of the node that has the parameter.
        name: the parameter's name.

    Raises:
        TutorialError: there is no such node or parameter, or this process uses the pocket ROS 2.
    """
    response = await _ask(node, await _find(node, target), "get_parameters", names=[name])
    if not response.values:
        raise TutorialError("Parameter not set")
    (value,) = response.values
    return f"{LABELS[value.type]} {parameter.parameter_value_to_python(value)}\n" if value.type else f"{LABELS[0]}\n"


async def param_set(node: Node, target: str, name: str, value: str) -> tuple[bool, str]:
    """Set a parameter, like ``ros2 param set``.

    Args:
        node: a node that spins on another thread and sends the requests.
        target: the name of the node that has the parameter.
        name: the parameter's name.
        value: the value in YAML. A number without a decimal point is an integer.

    Returns:
        Whether the node accepted the value, and the text that ``ros2 param set`` prints.

    Raises:
        TutorialError: there is no such node, the value is not valid YAML, or this process uses the pocket ROS 2.
    """
    found = await _find(node, target)
    response = await _ask(node, found, "set_parameters", parameters=[Parameter(name=name, value=_value(value))])
    (result,) = response.results
    text = "Set parameter successful" if result.successful else "Setting parameter failed"
    return result.successful, f"{text}: {result.reason}\n" if result.reason else f"{text}\n"


async def param_describe(node: Node, target: str, names: Sequence[str]) -> str:
    """Describe parameters, like ``ros2 param describe``.

    Args:
        node: a node that spins on another thread and sends the requests.
        target: the name of the node that has the parameters.
        names: the parameters' names.

    Raises:
        TutorialError: there is no such node, or this process uses the pocket ROS 2.
    """
    response = await _ask(node, await _find(node, target), "describe_parameters", names=list(names))
    return "".join(map(_description, response.descriptors))


async def param_dump(node: Node, target: str) -> str:
    """Return all parameters of a node as YAML for ``--params-file``, like ``ros2 param dump``.

    Args:
        node: a node that spins on another thread and sends the requests.
        target: the name of the node that has the parameters.

    Raises:
        TutorialError: there is no such node, or this process uses the pocket ROS 2.
    """
    found = await _find(node, target)
    names = await _names(node, found)
    response = await _ask(node, found, "get_parameters", names=names)
    values: dict[str, Any] = {}
    for name, value in zip(names, response.values):
        *parts, last = name.split(".")
        place = values
        for part in parts:
            place = place.setdefault(part, {})
        place[last] = parameter.parameter_value_to_python(value)
    return yaml.dump({found: {"ros__parameters": values}}, default_flow_style=False) + "\n"


async def _find(node: Node, target: str) -> str:
    """Return a node's full name; wait briefly for the node to appear.

    Raises:
        TutorialError: there is no such node, or this process uses the pocket ROS 2.
    """
    need_real_ros("Another node's parameter")
    name = target if target.startswith("/") else f"/{target}"
    await wait_for_graph(node, lambda: name in node_names(node))
    if name not in node_names(node):
        raise TutorialError("Node not found")
    return name


async def _ask(node: Node, target: str, name: str, **fields: Any) -> Any:
    """Call one of the services that every node has for its parameters.

    Args:
        node: the node that sends the requests.
        target: the full name of the node that has the parameters.
        name: the service's name, such as ``"get_parameters"``.
        fields: the fields of the request.

    Raises:
        TutorialError: the node does not offer the service, or does not respond.
    """
    kind = "".join(map(str.capitalize, name.split("_")))
    service = getattr(import_module("rcl_interfaces.srv"), kind)  # not at the top: the pocket ROS 2 lacks this module
    with client(node, service, f"{target}/{name}") as made:
        if not await is_ready(made, PATIENCE):
            text = "Wait for service timed out waiting for parameter services for node"
            raise TutorialError(f"{text} {escape_name(target)}")
        for _ in range(TRIES - 1):  # on a busy machine, ROS 2 can lose the response to a new client
            with suppress(TutorialError):
                return await response_to(made, service.Request(**fields), PATIENCE)
        return await response_to(made, service.Request(**fields), PATIENCE)


async def _names(node: Node, target: str) -> list[str]:
    response = await _ask(node, target, "list_parameters")
    return sorted(response.result.names)


def _indented(names: Sequence[str]) -> str:
    return "".join(f"  {escape_name(name)}\n" for name in names)


def _value(text: str) -> Any:
    """Parse a value in YAML, as ``ros2 param set`` does.

    Raises:
        TutorialError: the text is not valid YAML, or a number is out of range.
    """
    try:
        return parameter.get_parameter_value(text)
    except (yaml.YAMLError, AssertionError, ArithmeticError, ValueError) as error:
        raise TutorialError(f"{text!r} cannot be the value of a parameter: {error}") from error


def _description(descriptor: ParameterDescriptor) -> str:
    """Describe a parameter as ``ros2 param describe`` does."""
    lines = [f"Parameter name: {escape_name(descriptor.name)}", f"  Type: {NAMES[descriptor.type]}"]
    if descriptor.description:
        lines.append(f"  Description: {descriptor.description}")
    lines.append("  Constraints:")
    if descriptor.read_only:
        lines.append("    Read only: true")
    if ranges := [*descriptor.floating_point_range, *descriptor.integer_range]:
        limits = ranges[0]
        lines += [f"    Min value: {limits.from_value}", f"    Max value: {limits.to_value}"]
        if limits.step:
            lines.append(f"    Step: {limits.step}")
    if descriptor.additional_constraints:
        lines.append(f"    Additional constraints: {descriptor.additional_constraints}")
    return "".join(f"{line}\n" for line in lines)
