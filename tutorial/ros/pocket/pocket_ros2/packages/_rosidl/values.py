"""The values of message fields: types, containers and defaults."""

import math
import sys
from array import array
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from _rosidl.definitions import Cardinality, Field

FLOAT32_MAX = 3.402823466e38  # the literal in rosidl's checks


class Primitive(NamedTuple):
    """A primitive type in ROS 2 interface definitions.

    Attributes:
        idl: the type's name in IDL, as returned by ``get_fields_and_field_types()``.
        python: the Python type of a value.
        code: the type code for ``array.array`` (sequences) and for numpy's dtype (arrays); "" if the type is not
            numeric.
        limits: minimum and maximum of a number.
    """

    idl: str
    python: type
    code: str = ""
    limits: tuple[float, float] = (0, 0)

    @property
    def kind(self) -> str:
        """The word that ROS 2's checks use for a number of this type."""
        return self.idl if self.python is float else "integer" if self.limits[0] else "unsigned integer"

    def holds(self, number: Any) -> bool:
        """Return whether a number is within the limits, or is infinite or NaN."""
        return not (number < self.limits[0] or number > self.limits[1]) or number in (math.inf, -math.inf)


PRIMITIVES = {
    "bool": Primitive("boolean", bool),
    "byte": Primitive("octet", bytes),
    "string": Primitive("string", str),
    "float32": Primitive("float", float, "f", (-FLOAT32_MAX, FLOAT32_MAX)),
    "float64": Primitive("double", float, "d", (-sys.float_info.max, sys.float_info.max)),
}
for bits, code in (8, "b"), (16, "h"), (32, "i"), (64, "q"):
    PRIMITIVES[f"int{bits}"] = Primitive(f"int{bits}", int, code, (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1))
    PRIMITIVES[f"uint{bits}"] = Primitive(f"uint{bits}", int, code.upper(), (0, 2**bits - 1))


class Container(NamedTuple):
    """The container that holds a field's numbers.

    Attributes:
        kind: ``array.array`` for a sequence, ``numpy.ndarray`` for a fixed number of values.
        make: puts values into a new container, even if they are already in a container.
        default: returns an empty container or a container of zeros.
    """

    kind: type
    make: Callable[[Any], Any]
    default: Callable[[], Any]


def field_type(field: Field) -> str:
    """Return a field's type as ROS 2 writes it: ``"double[9]"``, ``"sequence<string>"``, ``"std_msgs/Header"``."""
    text = field.base.replace("/msg/", "/") if field.is_message else PRIMITIVES[field.base].idl
    if field.string_bound:
        text += f"<{field.string_bound}>"
    if field.cardinality is Cardinality.ARRAY:
        return f"{text}[{field.size}]"
    if field.cardinality is Cardinality.SEQUENCE:
        return f"sequence<{text}, {field.size}>" if field.size else f"sequence<{text}>"
    return text


def number_type(field: Field) -> Primitive | None:
    """Return the type of the field's numbers, or None if the field does not hold numbers."""
    primitive = PRIMITIVES.get(field.base)
    return primitive if primitive and primitive.code else None


def container(field: Field) -> Container | None:
    """Return the container of the field's numbers, or None if the field stores values unchanged."""
    number = number_type(field)
    if number is None or field.cardinality is Cardinality.SCALAR:
        return None
    code = number.code
    if field.cardinality is Cardinality.SEQUENCE:
        return Container(array, lambda value: array(code, value), lambda: array(code))
    return Container(np.ndarray, lambda value: np.array(value, code), lambda: np.zeros(field.size, code))


def default_factory(field: Field, element: type) -> Callable[[], Any]:
    """Return a function that returns the field's default value.

    Args:
        field: the field.
        element: the message class or Python type of the field's values.
    """
    if kept := container(field):
        return kept.default
    if field.cardinality is Cardinality.SEQUENCE:
        return list
    return (lambda: b"\0") if element is bytes else element
