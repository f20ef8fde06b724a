"""Parameters: a node's named settings."""

from array import array
from dataclasses import dataclass
from enum import Enum
from typing import Any, Self

from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterValue

PARAMETER_SEPARATOR_STRING = "."


@dataclass(frozen=True, eq=False, repr=False)
class Parameter:
    """A named, immutable setting; ``Node.set_parameters`` replaces it.

    Args:
        name: the parameter's name.
        type_: the parameter's type; if None, the type of the value.
        value: a value of a type that parameters can have.

    Raises:
        TypeError: parameters cannot have a value of this type.
        ValueError: the value is not of the given type.
    """

    class Type(Enum):
        """Types that parameters can have, numbered as in ``rcl_interfaces/msg/ParameterType``."""

        NOT_SET = 0
        BOOL = 1
        INTEGER = 2
        DOUBLE = 3
        STRING = 4
        BYTE_ARRAY = 5
        BOOL_ARRAY = 6
        INTEGER_ARRAY = 7
        DOUBLE_ARRAY = 8
        STRING_ARRAY = 9

        @classmethod
        def from_parameter_value(cls, parameter_value: Any) -> Self:
            """Return the type of a value.

            Raises:
                TypeError: the value is not of any of these types.
            """
            for type_ in cls:
                if type_._describes(parameter_value):
                    return type_
            a_list_of = "a list of " if isinstance(parameter_value, (list, tuple, array)) else ""
            raise TypeError(f"The given value is not {a_list_of}one of the allowed types '{parameter_value}'.")

        def check(self, parameter_value: Any) -> bool:
            """Return whether a parameter of this type can have the given value."""
            if not self._describes(parameter_value):
                return False
            if isinstance(parameter_value, array):
                return self.name in ("INTEGER_ARRAY", "DOUBLE_ARRAY")
            return self.name != "BYTE_ARRAY" or all(len(value) == 1 for value in parameter_value)

        def _describes(self, parameter_value: Any) -> bool:
            """Return whether a value is of this type; for an array type, check each element."""
            element, is_array = _PYTHON_TYPES[self.name.removesuffix("_ARRAY")], self.name.endswith("_ARRAY")
            values = parameter_value if is_array else [parameter_value]
            return isinstance(values, (list, tuple, array)) and all(isinstance(value, element) for value in values)

    name: str
    type_: Type = None  # type: ignore[assignment]  # None: infer the type from the value
    value: Any = None

    def __post_init__(self) -> None:
        given: Any = self.type_
        if given is None:
            object.__setattr__(self, "type_", Parameter.Type.from_parameter_value(self.value))
        elif not isinstance(given, Parameter.Type):
            raise TypeError(f"type must be an instance of '{Parameter.Type!r}'")
        if not self.type_.check(self.value):
            raise ValueError(f"Type '{self.type_}' and value '{self.value}' do not agree")

    @classmethod
    def from_parameter_msg(cls, param_msg: ParameterMessage) -> Self:
        """Create a parameter from a ``rcl_interfaces.msg.Parameter``."""
        type_ = cls.Type(param_msg.value.type)
        return cls(param_msg.name, type_, None if type_ == cls.Type.NOT_SET else _value(param_msg.value, type_))

    def get_parameter_value(self) -> ParameterValue:
        """Return the value as a ``rcl_interfaces.msg.ParameterValue``."""
        value = ParameterValue(type=self.type_.value)
        if self.type_ != Parameter.Type.NOT_SET:
            setattr(value, _field(self.type_), self.value)
        return value

    def to_parameter_msg(self) -> ParameterMessage:
        """Return the parameter as a ``rcl_interfaces.msg.Parameter``."""
        return ParameterMessage(name=self.name, value=self.get_parameter_value())


def get_parameter_value(string_value: str) -> ParameterValue:
    """Parse a value as ROS 2 does on a command line: ``"1"`` is an integer, ``"[a, b]"`` is a list of strings."""
    import yaml  # noqa: PLC0415  (rarely needed)

    try:
        value = yaml.safe_load(string_value)
    except yaml.parser.ParserError:
        value = string_value
    if value is None:
        value = string_value
    try:
        type_ = Parameter.Type.BOOL_ARRAY if value == [] else Parameter.Type.from_parameter_value(value)
    except TypeError:
        type_, value = Parameter.Type.STRING, string_value if isinstance(value, list) else value
    result = ParameterValue(type=type_.value)
    setattr(result, _field(type_), value)
    return result


def parameter_value_to_python(parameter_value: ParameterValue) -> Any:
    """Return the Python value of a ``rcl_interfaces.msg.ParameterValue``, or None if it is not set.

    Raises:
        RuntimeError: the type of the value is unknown.
    """
    try:
        type_ = Parameter.Type(parameter_value.type)
    except ValueError:
        raise RuntimeError(f"unexpected parameter type {parameter_value.type}") from None
    if type_ == Parameter.Type.NOT_SET:
        return None
    value = _value(parameter_value, type_)
    return list(value) if type_.name.endswith("_ARRAY") else value


def _field(type_: Parameter.Type) -> str:
    """Return the name of the ParameterValue field that holds values of a given type."""
    return f"{type_.name.lower()}_value"


def _value(message: ParameterValue, type_: Parameter.Type) -> Any:
    return getattr(message, _field(type_))


_PYTHON_TYPES = {"NOT_SET": type(None), "BOOL": bool, "INTEGER": int, "DOUBLE": float, "STRING": str, "BYTE": bytes}
