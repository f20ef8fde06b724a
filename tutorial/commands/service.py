"""The commands ``tank service`` and ``tank param``, which print what ``ros2 service`` and ``ros2 param`` print."""

# ruff: noqa: PLC0415 - rclpy is slow to import, and help must be fast

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from tutorial.commands.asking import query
from tutorial.system.printing import print_text, print_texts

if TYPE_CHECKING:
    from tutorial.ros.node_thread import MeteredNode


@click.group(short_help="List and call services, as ros2 service does.")
def service() -> None:
    """List and call services, as ros2 service does. This needs a real ROS 2."""


@service.command("list")
@click.option("-t", "--show-types", is_flag=True, help="Show the services' types.")
@query
async def list_services(node: MeteredNode, show_types: bool) -> None:
    """List the services."""
    from tutorial.ros.services import service_list

    print_text(await service_list(node, show_types))


@service.command("type")
@click.argument("service_name")
@query
async def show_type(node: MeteredNode, service_name: str) -> None:
    """Show a service's type."""
    from tutorial.ros.services import service_type

    print_text(await service_type(node, service_name))


@service.command()
@click.argument("service_name")
@click.argument("service_type")
@click.argument("values", default="{}")
@query
async def call(node: MeteredNode, service_name: str, service_type: str, values: str) -> None:
    """Call a service. VALUES are the fields of the request in YAML, such as '{data: true}'.

    As with ros2, the type can be abbreviated: std_srvs/SetBool.
    """
    from tutorial.ros.services import service_call

    await print_texts(service_call(node, service_name, service_type, values))


@click.group(short_help="List, read and set the parameters of nodes, as ros2 param does.")
def param() -> None:
    """List, read and set the parameters of nodes, as ros2 param does. This needs a real ROS 2."""


@param.command("list")
@click.argument("node_name", required=False)
@query
async def list_parameters(node: MeteredNode, node_name: str | None) -> None:
    """List the parameters of one node, or of all nodes."""
    from tutorial.ros.parameters import param_list

    print_text(await param_list(node, node_name))


@param.command()
@click.argument("node_name")
@click.argument("parameter_name")
@query
async def get(node: MeteredNode, node_name: str, parameter_name: str) -> None:
    """Show the value of a parameter."""
    from tutorial.ros.parameters import param_get

    print_text(await param_get(node, node_name, parameter_name))


@param.command("set", context_settings={"ignore_unknown_options": True})  # VALUE can be negative, such as -1.0
@click.argument("node_name")
@click.argument("parameter_name")
@click.argument("value")
@query
async def set_parameter(node: MeteredNode, node_name: str, parameter_name: str, value: str) -> None:
    """Set a parameter. VALUE is in YAML, so 60 is an integer, and 60.0 is a double."""
    from tutorial.ros.parameters import param_set

    accepted, text = await param_set(node, node_name, parameter_name, value)
    print_text(text, err=not accepted)


@param.command()
@click.argument("node_name")
@click.argument("parameter_names", nargs=-1, required=True)
@query
async def describe(node: MeteredNode, node_name: str, parameter_names: tuple[str, ...]) -> None:
    """Show the types, descriptions and ranges of parameters."""
    from tutorial.ros.parameters import param_describe

    print_text(await param_describe(node, node_name, parameter_names))


@param.command()
@click.argument("node_name")
@query
async def dump(node: MeteredNode, node_name: str) -> None:
    """Print all parameters of a node in YAML, for --params-file."""
    from tutorial.ros.parameters import param_dump

    print_text(await param_dump(node, node_name))
