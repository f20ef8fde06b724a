"""Check parameters and their declarations, using rclpy's error messages."""

import math
import warnings
from collections.abc import Sequence
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.parameter import Parameter
from rclpy.validate_parameter_name import validate_parameter_name

DEPRECATED = """when declaring parameter named '{name}', declaring a parameter only providing its name is deprecated. \
You have to either:
\t- Pass a name and a default value different to "PARAMETER NOT SET" (and optionally a descriptor).
\t- Pass a name and a parameter type.
\t- Pass a name and a descriptor with `dynamic_typing=True"""

TOLERANCE = 1e-6
"""Floating-point numbers count as equal if their relative difference is smaller than this."""


def read_declaration(
    namespace: str, given: Sequence[Any], index: int, stacklevel: int
) -> tuple[str, Any, ParameterDescriptor]:
    """Return the name, value and descriptor of a declaration.

    Args:
        namespace: prefix of the name.
        given: the declaration's name, value or type, and descriptor; the last two elements are optional.
        index: position in the list of declarations, for error messages.
        stacklevel: which caller the warning about a missing type points to; 1 means the caller of this function.

    Raises:
        TypeError: the declaration does not have one to three elements, or an element has the wrong type.
        ValueError: neither the value nor the descriptor determines the parameter's type, or both do.
        InvalidParameterException: the name is empty.
    """
    if not 1 <= len(given) <= 3:
        raise TypeError(
            f"Invalid parameter tuple length at index {index} in parameters list: {given}; "
            "expecting length between 1 and 3"
        )
    name, value, descriptor = (*given, None, None)[:3]
    if not isinstance(name, str):
        raise TypeError(f"First element {name} at index {index} in parameters list is not a str.")
    name = f"{namespace}.{name}" if namespace else name
    validate_parameter_name(name)
    if len(given) < 3:
        descriptor = ParameterDescriptor(dynamic_typing=len(given) == 1)
    if not isinstance(descriptor, ParameterDescriptor):
        raise TypeError(f"Third element {descriptor} at index {index} in parameters list is not a ParameterDescriptor.")
    if len(given) == 1:
        warnings.warn(DEPRECATED.format(name=name), stacklevel=stacklevel + 1)
    if isinstance(value, Parameter.Type):
        _set_type(name, value, descriptor)
        value = None
    elif not descriptor.dynamic_typing:
        type_ = Parameter.Type.from_parameter_value(value)
        if type_ == Parameter.Type.NOT_SET:
            raise ValueError("Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET")
        descriptor.type = type_.value
    return name, value, descriptor


def _set_type(name: str, type_: Parameter.Type, descriptor: ParameterDescriptor) -> None:
    """Set a descriptor's type to the type that a declaration gives instead of a value."""
    if type_ == Parameter.Type.NOT_SET:
        raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
    if descriptor.dynamic_typing:
        raise ValueError(
            f"When declaring parameter {{{name}}} passing a descriptor with`dynamic_typing=True` is not allowed "
            "when the parameter type is provided"
        )
    descriptor.type = type_.value


def refusal(parameter: Parameter, descriptor: ParameterDescriptor, is_declared: bool) -> str:
    """Return why a descriptor rejects a parameter, or "" if it does not.

    Also set the descriptor's name and, if the parameter is dynamically typed, the descriptor's type.
    """
    descriptor.name = parameter.name
    if descriptor.dynamic_typing:
        descriptor.type = parameter.type_.value
    elif parameter.type_ == Parameter.Type.NOT_SET:
        return "Static parameter cannot be undeclared" if is_declared else ""
    elif parameter.type_.value != descriptor.type:
        expected = Parameter.Type(descriptor.type)
        return f"Wrong parameter type, expected '{expected}' got '{parameter.type_}'"
    if parameter.type_ == Parameter.Type.INTEGER and descriptor.integer_range:
        return _outside(parameter, descriptor.integer_range[0], 0.0, ".", "a valid step")
    if parameter.type_ == Parameter.Type.DOUBLE and descriptor.floating_point_range:
        return _outside(parameter, descriptor.floating_point_range[0], TOLERANCE, "", "close enough to a valid step")
    return ""


def _outside(parameter: Parameter, limits: Any, tolerance: float, stop: str, step: str) -> str:
    """Return why a range rejects a number, or "" if it does not; rclpy's messages for integers and floats differ."""
    low, high = sorted((limits.from_value, limits.to_value))
    name, value = parameter.name, parameter.value
    if any(math.isclose(value, limit, rel_tol=tolerance) for limit in (low, high)):
        return ""
    if not low < value < high:
        return f"Parameter {name} out of range{stop} Min: {low}, Max: {high}, value: {value}"
    nearest = low + round((value - low) / limits.step) * limits.step if limits.step else value
    if math.isclose(nearest, value, rel_tol=tolerance):
        return ""
    return f"The parameter value for {name} is not {step}. Min: {low}, max: {high}, value: {value}, step: {limits.step}"


def is_listed(name: str, prefixes: Sequence[str], depth: int) -> bool:
    """Return whether ``Node.list_parameters`` lists a parameter.

    Args:
        name: the parameter's name.
        prefixes: list only these names and the names below them; an empty list means all names.
        depth: how many levels of names to list; 0 means all.
    """
    if not prefixes:
        return not depth or name.count(".") < depth
    below = (name.removeprefix(f"{prefix}.") for prefix in prefixes if name.startswith(f"{prefix}."))
    return name in prefixes or any(not depth or rest.count(".") < depth for rest in below)
