"""What rclpy has and the embedded ROS 2 has not: whoever asks for it learns what needs a real ROS 2."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from rclpy.exceptions import AbsentAttributeError, NeedsRealROSError

MODULES = """action callback_groups client event_handler experimental graph_listener guard_condition lifecycle
    logging_service parameter_client parameter_event_handler parameter_service qos_event qos_overriding_options service
    service_introspection time_source type_description_service type_support wait_for_message waitable"""
EXECUTORS = "MultiThreadedExecutor TimeoutException ShutdownException await_or_execute"
EXECUTOR = "create_task can_execute wait_for_ready_callbacks spin_once_until_future_complete"
CLOCK = "sleep_for sleep_until create_jump_callback set_ros_time_override"
NODE = """add_on_set_parameters_callback add_post_set_parameters_callback add_pre_set_parameters_callback add_waitable
    clients count_clients count_services create_client create_guard_condition create_rate create_service
    declare_parameters default_callback_group describe_parameter describe_parameters destroy_client
    destroy_guard_condition destroy_rate destroy_service get_client_names_and_types_by_node
    get_fully_qualified_node_names get_node_names_and_namespaces_with_enclaves get_parameter_type get_parameter_types
    get_parameters get_parameters_by_prefix get_service_names_and_types get_service_names_and_types_by_node guards
    handle list_parameters
    remove_on_set_parameters_callback remove_post_set_parameters_callback remove_pre_set_parameters_callback
    remove_waitable resolve_service_name services set_descriptor set_parameters_atomically undeclare_parameter
    wait_for_node waitables"""
NODE_OPTIONS = "allow_undeclared_parameters automatically_declare_parameters_from_overrides enable_logger_service"
ENDPOINT_OPTIONS = "callback_group event_callbacks qos_overriding_options publisher_class content_filter_options"


def absent(owner: str, names: str) -> Callable[..., Any]:
    """Return a ``__getattr__`` for a module or class that refuses these names.

    Args:
        owner: what to call it, such as ``"rclpy.executors"`` or ``"Node"``.
        names: what rclpy's has and ours has not, separated by blanks.
    """

    def refusing(*arguments: Any) -> Any:
        *instance, name = arguments
        if name in names.split():
            raise (AbsentAttributeError if instance else NeedsRealROSError)(f"{owner}.{name}")
        what = f"{type(instance[0]).__name__!r} object" if instance else f"module {owner!r}"
        raise AttributeError(f"{what} has no attribute {name!r}")

    return refusing


def refuse(function: str, options: dict[str, Any], known: str) -> None:
    """Refuse options of a function that rclpy's has and ours has not, if they are used.

    Raises:
        NeedsRealROSError: one of them is.
        TypeError: rclpy's does not have it either.
    """
    for option, value in options.items():
        if option not in known.split():
            raise TypeError(f"{function}() got an unexpected keyword argument {option!r}")
        if value:
            raise NeedsRealROSError(f"{function}({option}=...)")


def refuse_coroutine(callback: Any) -> None:
    """Refuse a callback that is a coroutine function.

    Raises:
        NeedsRealROSError: it is.
    """
    if inspect.iscoroutinefunction(callback):
        raise NeedsRealROSError("callbacks that are coroutines")


class AbsentModules(MetaPathFinder, Loader):
    """Finds the modules of rclpy that are not here, and refuses to load them."""

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:  # noqa: ARG002
        """Answer for these modules, and for nothing else."""
        package, _, name = fullname.partition(".")
        return ModuleSpec(fullname, self) if package == "rclpy" and name in MODULES.split() else None

    def exec_module(self, module: ModuleType) -> None:
        """Raise NeedsRealROSError."""
        raise NeedsRealROSError(module.__name__)
