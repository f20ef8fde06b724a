"""What a node keeps of parameters. They are not served to other nodes: that needs services."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from rclpy._arguments import Arguments
from rclpy.exceptions import ParameterAlreadyDeclaredException, ParameterNotDeclaredException
from rclpy.parameter import Parameter

__all__ = ["NodeParameters", "SetParametersResult"]


@dataclass
class SetParametersResult:
    """Whether a parameter was set, and if not, why."""

    successful: bool
    reason: str = ""


class NodeParameters:
    """The part of a node that deals with parameters."""

    def _init_parameters(self, arguments: list[Arguments]) -> None:
        self._parameters: dict[str, Parameter] = {}
        self._overrides: dict[str, Any] = {}
        for given in reversed(arguments):
            self._overrides.update(given.parameters)

    def declare_parameter(self, name: str, value: Any = None, descriptor: Any = None, **_: Any) -> Parameter:  # noqa: ARG002
        """Make a parameter; a value on the command line wins over the one given here.

        Raises:
            ParameterAlreadyDeclaredException: there is one of this name.
        """
        if name in self._parameters:
            raise ParameterAlreadyDeclaredException(name)
        self._parameters[name] = Parameter(name, value=self._overrides.get(name, value))
        return self._parameters[name]

    def has_parameter(self, name: str) -> bool:
        """Whether the parameter has been declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter.

        Raises:
            ParameterNotDeclaredException: it has not been declared.
        """
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        return self._parameters[name]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or something else if it has not been declared."""
        return self._parameters.get(name) or alternative_value or Parameter(name)

    def set_parameters(self, parameter_list: Sequence[Parameter]) -> list[SetParametersResult]:
        """Change parameters; one whose type would change stays as it is.

        Raises:
            ParameterNotDeclaredException: one has not been declared.
        """
        return [self._set(parameter) for parameter in parameter_list]

    def _set(self, parameter: Parameter) -> SetParametersResult:
        declared = self.get_parameter(parameter.name)
        if declared.type_ not in (parameter.type_, Parameter.Type.NOT_SET):
            reason = f"Wrong parameter type, expected '{declared.type_.name}' got '{parameter.type_.name}'"
            return SetParametersResult(successful=False, reason=reason)
        self._parameters[parameter.name] = parameter
        return SetParametersResult(successful=True)
