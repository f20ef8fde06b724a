"""Parameters: a node's named settings."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

__all__ = ["Parameter"]


class Parameter:
    """A named setting.

    Args:
        name: of the parameter.
        type_: None takes the value's.
        value: of one of the types that parameters can have.

    Raises:
        TypeError: parameters cannot have such a value.
        ValueError: the value is not of the type given.
    """

    class Type(IntEnum):
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
        def from_parameter_value(cls, value: Any) -> Parameter.Type:
            """Return the type of a value."""
            if isinstance(value, (list, tuple)):
                if not value or isinstance(value[0], bytes):
                    return cls.BYTE_ARRAY
                if len({type(item) for item in value}) == 1 and (element := _SCALARS.get(type(value[0]))):
                    return cls[f"{cls(element).name}_ARRAY"]
            elif (scalar := _SCALARS.get(type(value))) is not None:
                return cls(scalar)
            raise TypeError(
                "The given value is not one of the allowed types '{}'.".format("', '".join(t.name for t in cls))
            )

    def __init__(self, name: str, type_: Parameter.Type | None = None, value: Any = None) -> None:
        found = Parameter.Type.from_parameter_value(value)
        if type_ is not None and type_ != found:
            raise ValueError(f"Type '{type_.name}' and value '{value}' do not agree")
        self.name = name
        self.type_ = found
        self.value = value

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Parameter) and (self.name, self.type_, self.value) == (
            other.name,
            other.type_,
            other.value,
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Parameter(name={self.name!r}, type={self.type_.name}, value={self.value!r})"


_SCALARS = {type(None): 0, bool: 1, int: 2, float: 3, str: 4}
