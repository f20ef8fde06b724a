"""Parameters: a node's named settings."""

from array import array
from dataclasses import dataclass
from enum import Enum
from typing import Any, Self

PARAMETER_SEPARATOR_STRING = "."


@dataclass(frozen=True, eq=False, repr=False)
class Parameter:
    """A named setting, which cannot be changed; ``Node.set_parameters`` puts another one in its place.

    Args:
        name: of the parameter.
        type_: None takes the value's.
        value: of one of the types that parameters can have.

    Raises:
        TypeError: parameters cannot have such a value.
        ValueError: the value is not of the type given.
    """

    class Type(Enum):
        """Types that parameters can have, with the numbers of ``rcl_interfaces/msg/ParameterType``."""

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
                TypeError: it is of none of them.
            """
            for type_ in cls:
                if type_.check(parameter_value):
                    return type_
            a_list_of = "a list of " if isinstance(parameter_value, (list, tuple, array)) else ""
            raise TypeError(f"The given value is not {a_list_of}one of the allowed types '{parameter_value}'.")

        def check(self, parameter_value: Any) -> bool:
            """Whether a value is of this type."""
            element, is_array = _PYTHON_TYPES[self.name.removesuffix("_ARRAY")], self.name.endswith("_ARRAY")
            values = parameter_value if is_array else [parameter_value]
            return isinstance(values, (list, tuple, array)) and all(isinstance(value, element) for value in values)

    name: str
    type_: Type = None  # type: ignore[assignment]  # the value's
    value: Any = None

    def __post_init__(self) -> None:
        given: Any = self.type_
        if given is None:
            object.__setattr__(self, "type_", Parameter.Type.from_parameter_value(self.value))
        elif not isinstance(given, Parameter.Type):
            raise TypeError(f"type must be an instance of '{Parameter.Type!r}'")
        if not self.type_.check(self.value):
            raise ValueError(f"Type '{self.type_}' and value '{self.value}' do not agree")


_PYTHON_TYPES = {"NOT_SET": type(None), "BOOL": bool, "INTEGER": int, "DOUBLE": float, "STRING": str, "BYTE": bytes}
