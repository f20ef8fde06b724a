"""``ros2 service`` and ``ros2 param`` as functions for cells, with the same output.

These functions need a real ROS 2.
"""

from tutorial.notebook.topic_tools import TIMEOUT, asker
from tutorial.ros import parameters, services
from tutorial.system.printing import print_text, print_texts


async def service_list(show_types: bool = False) -> None:
    """Print the services, as ``ros2 service list`` does.

    Args:
        show_types: whether to also print the services' types, as with ``-t``.
    """
    print_text(await services.service_list(asker(), show_types))


async def service_call(service: str, type_name: str, values: str = "{}") -> None:
    """Call a service, and print the request and the response, as ``ros2 service call`` does.

    Args:
        service: the service's name.
        type_name: the service's type, such as ``"std_srvs/srv/SetBool"``.
        values: the fields of the request in YAML, such as ``"{data: true}"``.

    Raises:
        TutorialError: the type or a value is invalid, or the service does not respond within 10 s.
    """
    await print_texts(services.service_call(asker(), service, type_name, values, TIMEOUT))


async def param_list(node: str | None = None) -> None:
    """Print the parameters of a node, or of all nodes, as ``ros2 param list`` does.

    Args:
        node: the node's name; None for all nodes.

    Raises:
        TutorialError: there is no such node. All parameter functions can raise this error.
    """
    print_text(await parameters.param_list(asker(), node))


async def param_get(node: str, name: str) -> None:
    """Print the value of a parameter, as ``ros2 param get`` does.

    Args:
        node: the node's name.
        name: the parameter's name.
    """
    print_text(await parameters.param_get(asker(), node, name))


async def param_set(node: str, name: str, value: object) -> None:
    """Set a parameter, and print whether the node accepts it, as ``ros2 param set`` does.

    Args:
        node: the node's name.
        name: the parameter's name.
        value: the value, as a Python object or as YAML text.
    """
    _, text = await parameters.param_set(asker(), node, name, str(value))
    print_text(text)


async def param_describe(node: str, *names: str) -> None:
    """Print the types, descriptions and ranges of parameters, as ``ros2 param describe`` does.

    Args:
        node: the node's name.
        names: the parameters' names.
    """
    print_text(await parameters.param_describe(asker(), node, names))


async def param_dump(node: str) -> None:
    """Print all parameters of a node as YAML, as ``ros2 param dump`` does.

    Args:
        node: the node's name.
    """
    print_text(await parameters.param_dump(asker(), node))
