"""What a node keeps of parameters. They are not served to other nodes: that needs services."""

import math
import warnings
from collections.abc import Callable, Iterable, Sequence
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy import exceptions
from rclpy._arguments import Arguments
from rclpy.parameter import Parameter

DEPRECATED = """when declaring parameter named '{name}', declaring a parameter only providing its name is deprecated. \
You have to either:
\t- Pass a name and a default value different to "PARAMETER NOT SET" (and optionally a descriptor).
\t- Pass a name and a parameter type.
\t- Pass a name and a descriptor with `dynamic_typing=True"""


class NodeParameters:
    """The part of a node that deals with parameters."""

    PARAM_REL_TOL = 1e-6

    _use_sim_time: Callable[[bool], None]
    """Has the node's clock go by simulated time from now on, or by the system's."""

    def _init_parameters(self, name: str, arguments: list[Arguments], given: Iterable[Parameter]) -> None:
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, ParameterDescriptor] = {}
        self._overrides: dict[str, Any] = {}
        for source in reversed(arguments):
            self._overrides.update(source.overrides(name))
        self._overrides.update((parameter.name, parameter.value) for parameter in given)
        self.declare_parameter("use_sim_time", False)

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: ParameterDescriptor | None = None, ignore_override: bool = False
    ) -> Parameter:
        """Make a parameter; a value on the command line wins over the one given here.

        Args:
            name: of the parameter.
            value: its value, or only its type.
            descriptor: what values it may have, and whether it can be changed.
            ignore_override: don't handle_signals the command line.

        Raises:
            ParameterAlreadyDeclaredException: there is one of this name.
            InvalidParameterTypeException: the command line's value is of another type.
            InvalidParameterValueException: the descriptor does not allow the value.
        """
        descriptor = _typed(name, value, descriptor)
        if isinstance(value, Parameter.Type):
            value = None
        if not ignore_override:
            value = self._overrides.get(name, value)
        parameter = Parameter(name, value=value)
        if name in self._parameters:
            raise exceptions.ParameterAlreadyDeclaredException([name])
        reason = self._refusal(parameter, descriptor)
        if reason.startswith("Wrong parameter type"):
            raise exceptions.InvalidParameterTypeException(parameter, Parameter.Type(descriptor.type).name)
        if reason:
            raise exceptions.InvalidParameterValueException(name, value, reason)
        self._parameters[name], self._descriptors[name] = parameter, descriptor
        return parameter

    def has_parameter(self, name: str) -> bool:
        """Whether the parameter has been declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter.

        Raises:
            ParameterNotDeclaredException: it has not been declared.
            ParameterUninitializedException: it has been declared by its type, and has no value.
        """
        if name not in self._parameters:
            raise exceptions.ParameterNotDeclaredException(name)
        parameter = self._parameters[name]
        if parameter.type_ == Parameter.Type.NOT_SET and not self._descriptors[name].dynamic_typing:
            raise exceptions.ParameterUninitializedException(name)
        return parameter

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or something else if it has not been declared or has no value."""
        parameter = self._parameters.get(name)
        if parameter is None or parameter.type_ == Parameter.Type.NOT_SET:
            return Parameter(name, Parameter.Type.NOT_SET) if alternative_value is None else alternative_value
        return parameter

    def set_parameters(self, parameter_list: Sequence[Parameter]) -> list[SetParametersResult]:
        """Change parameters, and return for each whether it was, and if not, why.

        Raises:
            ParameterNotDeclaredException: one has not been declared.
        """
        return [self._set(parameter) for parameter in parameter_list]

    def _set(self, parameter: Parameter) -> SetParametersResult:
        if not isinstance(parameter, Parameter):
            raise TypeError(f"parameter must be instance of type '{Parameter!r}'")
        name = parameter.name
        if name not in self._parameters:
            raise exceptions.ParameterNotDeclaredException([name])
        if self._descriptors[name].read_only:
            reason = f"Trying to set a read-only parameter: {name}."
        else:
            reason = self._refusal(parameter, self._descriptors[name])
        if not reason:
            self._parameters[name] = parameter
            if parameter.type_ == Parameter.Type.NOT_SET:
                del self._parameters[name], self._descriptors[name]
            if name == "use_sim_time":
                self._use_sim_time(parameter.value)
        return SetParametersResult(successful=not reason, reason=reason)

    def _refusal(self, parameter: Parameter, descriptor: ParameterDescriptor) -> str:
        """Return why a parameter may not have this value, "" if it may."""
        descriptor.name = parameter.name
        if descriptor.dynamic_typing:
            descriptor.type = parameter.type_.value
        elif parameter.type_ == Parameter.Type.NOT_SET:
            return "Static parameter cannot be undeclared" if self.has_parameter(parameter.name) else ""
        elif parameter.type_.value != descriptor.type:
            expected = Parameter.Type(descriptor.type)
            return f"Wrong parameter type, expected '{expected}' got '{parameter.type_}'"
        if parameter.type_ == Parameter.Type.INTEGER and descriptor.integer_range:
            return _outside(parameter, descriptor.integer_range[0], 0.0, ".", "a valid step")
        if parameter.type_ == Parameter.Type.DOUBLE and descriptor.floating_point_range:
            limits = descriptor.floating_point_range[0]
            return _outside(parameter, limits, self.PARAM_REL_TOL, "", "close enough to a valid step")
        return ""


def _typed(name: str, value: Any, descriptor: ParameterDescriptor | None) -> ParameterDescriptor:
    """Return a parameter's descriptor, with the type that its value has."""
    if not isinstance(name, str):
        raise TypeError(f"First element {name} at index 0 in parameters list is not a str.")
    if not name:
        raise exceptions.InvalidParameterException(name)
    if descriptor is None:
        descriptor = ParameterDescriptor(dynamic_typing=value is None)
        if value is None:
            warnings.warn(DEPRECATED.format(name=name), stacklevel=3)
    if not isinstance(descriptor, ParameterDescriptor):
        raise TypeError(f"Third element {descriptor} at index 0 in parameters list is not a ParameterDescriptor.")
    if isinstance(value, Parameter.Type):
        if value == Parameter.Type.NOT_SET:
            raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
        if descriptor.dynamic_typing:
            raise ValueError(
                f"When declaring parameter {{{name}}} passing a descriptor with`dynamic_typing=True` is not allowed "
                "when the parameter type is provided"
            )
        descriptor.type = value.value
    elif not descriptor.dynamic_typing:
        type_ = Parameter.Type.from_parameter_value(value)
        if type_ == Parameter.Type.NOT_SET:
            raise ValueError("Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET")
        descriptor.type = type_.value
    return descriptor


def _outside(parameter: Parameter, limits: Any, tolerance: float, stop: str, step: str) -> str:
    """Return why a number is not in a range, with rclpy's words for integers and for others, "" if it is."""
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
