"""rclpy's exceptions, and two exceptions that the pocket ROS 2 adds."""

from typing import Any, ClassVar

from _absent import AbsentAttributeError as AbsentAttributeError  # noqa: PLC0414  (re-export)
from _absent import NeedsRealROSError as NeedsRealROSError  # noqa: PLC0414
from rclpy._rclpy_pybind11 import InvalidHandle as InvalidHandle  # noqa: PLC0414  (re-export)


class NotInitializedException(Exception):  # noqa: N818  (rclpy's name, like all names below)
    """``rclpy.init()`` has not been called."""

    def __init__(self, message: str | None = None) -> None:
        super().__init__("rclpy.init() has not been called." + (f" msg:{message}" if message else ""))


class ROSInterruptException(Exception):  # noqa: N818
    """A shutdown interrupted a wait."""

    def __init__(self) -> None:
        super().__init__("rclpy.shutdown() has been called")


class NoTypeSupportImportedException(Exception):  # noqa: N818
    """A message type is not supported."""

    def __init__(self) -> None:
        super().__init__("no type_support imported")


class NameValidationException(Exception):  # noqa: N818
    """A name breaks the naming rules; the error message marks the position of the error."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__(f"Invalid {name_type}: {error_msg}:\n  '{name}'\n   {' ' * invalid_index}^")


class _InvalidName(NameValidationException):
    kind: ClassVar[str]

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__(self.kind, name, error_msg, invalid_index)


class InvalidNodeNameException(_InvalidName):
    """A node name breaks the naming rules."""

    kind = "node name"


class InvalidNamespaceException(_InvalidName):
    """A namespace breaks the naming rules."""

    kind = "namespace"


class InvalidTopicNameException(_InvalidName):
    """A topic name breaks the naming rules."""

    kind = "topic name"


class InvalidServiceNameException(_InvalidName):
    """A service name breaks the naming rules."""

    kind = "service name"


class ParameterException(Exception):  # noqa: N818
    """Base class of the parameter exceptions."""

    def __init__(self, error_msg: str, parameters: str | list[str]) -> None:
        super().__init__(f"{error_msg}: {parameters}")


class ParameterNotDeclaredException(ParameterException):
    """A program used an undeclared parameter."""

    def __init__(self, parameters: str | list[str]) -> None:
        super().__init__("Invalid access to undeclared parameter(s)", parameters)


class ParameterAlreadyDeclaredException(ParameterException):
    """A parameter was declared twice."""

    def __init__(self, parameters: str | list[str]) -> None:
        super().__init__("Parameter(s) already declared", parameters)


class ParameterUninitializedException(ParameterException):
    """A program read a parameter that has a type, but no value yet."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__(f"The parameter '{parameter_name}' is not initialized", parameter_name)


class InvalidParameterException(ParameterException):
    """A parameter's name is invalid."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Invalid parameter name", parameter_name)


class InvalidParameterTypeException(ParameterException):
    """A parameter's value has the wrong type."""

    from rclpy.parameter import Parameter  # noqa: PLC0415  (as in rclpy, where this class has it)

    def __init__(self, desired_parameter: Parameter, expected_type: str) -> None:
        name, value, given = desired_parameter.name, desired_parameter.value, desired_parameter.type_.name
        text = f"Trying to set parameter '{name}' to '{value}' of type '{given}', expecting type '{expected_type}'"
        super().__init__(text, name)


class InvalidParameterValueException(ParameterException):
    """A parameter's value is not allowed by its descriptor."""

    def __init__(self, parameter: str, value: Any, reason: str) -> None:
        super().__init__(f"Invalid parameter value ({value}) for parameter. Reason: {reason}", parameter)


class ParameterImmutableException(ParameterException):
    """A program tried to change a read-only parameter."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Attempted to modify read-only parameter", parameter_name)
