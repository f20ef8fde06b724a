"""rclpy's exceptions, and the one that the underlay adds."""

from __future__ import annotations

__all__ = [
    "InvalidNamespaceException",
    "InvalidNodeNameException",
    "InvalidTopicNameException",
    "NameValidationException",
    "NeedsRealROSError",
    "NotInitializedException",
    "ParameterAlreadyDeclaredException",
    "ParameterNotDeclaredException",
]


class NotInitializedException(Exception):  # noqa: N818  (rclpy's name, as all below)
    """``rclpy.init()`` has not been called."""

    def __init__(self, msg: str = "") -> None:
        super().__init__("rclpy.init() has not been called" + (f". msg:{msg}" if msg else ""))


class NameValidationException(Exception):  # noqa: N818
    """A name breaks the rules for names; the text points at the place."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int) -> None:
        caret = " " * invalid_index + "^"
        super().__init__(f"Invalid {name_type}: {error_msg}:\n  '{name}'\n   {caret}")
        self.name_type, self.name, self.error_msg, self.invalid_index = (
            name_type,
            name,
            error_msg,
            invalid_index,
        )


class InvalidNodeNameException(NameValidationException):
    """A node name breaks the rules for names."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("node name", name, error_msg, invalid_index)


class InvalidNamespaceException(NameValidationException):
    """A namespace breaks the rules for names."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("namespace", name, error_msg, invalid_index)


class InvalidTopicNameException(NameValidationException):
    """A topic name breaks the rules for names."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("topic name", name, error_msg, invalid_index)


class ParameterNotDeclaredException(Exception):  # noqa: N818
    """A parameter was read that the node has not declared."""

    def __init__(self, parameters: str | list[str]) -> None:
        names = [parameters] if isinstance(parameters, str) else parameters
        super().__init__(f"Invalid access to undeclared parameter(s): {', '.join(names)}")


class ParameterAlreadyDeclaredException(Exception):  # noqa: N818
    """A parameter was declared twice."""

    def __init__(self, parameters: str | list[str]) -> None:
        names = [parameters] if isinstance(parameters, str) else parameters
        super().__init__(f"Parameter(s) already declared: {names}")


class NeedsRealROSError(ImportError):
    """Something was asked for that the embedded ROS 2 does not have.

    An ImportError, because most of it is met at an import line.
    """

    def __init__(self, what: str) -> None:
        super().__init__(
            f"The embedded ROS 2 of this tutorial has no {what}. A real ROS 2 Jazzy has: see "
            "https://docs.ros.org/en/jazzy/Installation.html, source its setup.bash and start again."
        )
