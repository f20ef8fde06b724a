"""What a field may hold: its default, its container, and rclpy's checks."""

from __future__ import annotations

import math
import sys
from array import array
from collections import UserList, UserString
from collections.abc import Callable, Sequence, Set
from typing import Any, NamedTuple

import numpy as np

from _rosidl.definitions import Cardinality, Field

__all__ = ["PRIMITIVES", "Primitive", "checker", "container", "default_factory", "field_type"]

FLOAT32_MAX = 3.402823466e38  # the literal that rosidl's checks are made of
NO_LIMITS = (0.0, 0.0)


class Primitive(NamedTuple):
    """A primitive type of the interface language.

    Attributes:
        idl: its name in IDL, which ``get_fields_and_field_types()`` shows.
        python: the type of a value.
        code: of ``array.array`` for sequences and of the dtype for arrays; "" if these are lists.
        limits: smallest and largest value.
    """

    idl: str
    python: type
    code: str = ""
    limits: tuple[float, float] = NO_LIMITS


def _signed(bits: int, code: str) -> Primitive:
    return Primitive(f"int{bits}", int, code, (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1))


def _unsigned(bits: int, code: str) -> Primitive:
    return Primitive(f"uint{bits}", int, code, (0, 2**bits - 1))


PRIMITIVES = {
    "bool": Primitive("boolean", bool),
    "byte": Primitive("octet", bytes),
    "int8": _signed(8, "b"),
    "int16": _signed(16, "h"),
    "int32": _signed(32, "i"),
    "int64": _signed(64, "q"),
    "uint8": _unsigned(8, "B"),
    "uint16": _unsigned(16, "H"),
    "uint32": _unsigned(32, "I"),
    "uint64": _unsigned(64, "Q"),
    "float32": Primitive("float", float, "f", (-FLOAT32_MAX, FLOAT32_MAX)),
    "float64": Primitive("double", float, "d", (-sys.float_info.max, sys.float_info.max)),
    "string": Primitive("string", str),
}


def field_type(field: Field) -> str:
    """Write a field's type as ROS 2 does: ``"double[9]"``, ``"sequence<string>"``, ``"std_msgs/Header"``."""
    text = field.base.replace("/msg/", "/") if field.is_message else PRIMITIVES[field.base].idl
    if field.string_bound:
        text += f"<{field.string_bound}>"
    if field.cardinality is Cardinality.ARRAY:
        return f"{text}[{field.size}]"
    if field.cardinality is Cardinality.SEQUENCE:
        return f"sequence<{text}, {field.size}>" if field.size else f"sequence<{text}>"
    return text


def container(field: Field) -> Callable[[Any], Any] | None:
    """Return what turns a value into the container that the field keeps, or None if it keeps the value itself."""
    code = "" if field.is_message else PRIMITIVES[field.base].code
    if not code or field.cardinality is Cardinality.SCALAR:
        return None
    if field.cardinality is Cardinality.SEQUENCE:
        return lambda value: array(code, value)
    return lambda value: np.array(bytearray(value) if isinstance(value, bytes) else value, dtype=code)


def default_factory(field: Field, element: type) -> Callable[[], Any]:
    """Return what makes the field's default value.

    Args:
        field: which one.
        element: the message class or Python type of its values.
    """
    make = (lambda: b"\0") if element is bytes else element
    if field.cardinality is Cardinality.SCALAR:
        return make
    if field.cardinality is Cardinality.SEQUENCE:
        return list
    return lambda: [make() for _ in range(field.size)]


def checker(field: Field, element: type) -> Callable[[Any], None]:
    """Return rclpy's check of the field, which runs only for messages made with ``check_fields=True``.

    The check raises an AssertionError with rclpy's text.
    """
    accepts, demand = (
        _one_value(field, element) if field.cardinality is Cardinality.SCALAR else _many_values(field, element)
    )
    problem = f"The '{field.name}' field must be {demand}"

    def check(value: Any) -> None:
        if not accepts(value):
            raise AssertionError(problem)

    return check


def _one_value(field: Field, element: type) -> tuple[Callable[[Any], bool], str]:
    limits = NO_LIMITS if field.is_message else PRIMITIVES[field.base].limits
    if field.is_message:
        return lambda value: isinstance(value, element), f"a sub message of type '{element.__name__}'"
    if element is bytes:
        return (
            lambda value: isinstance(value, bytes) and len(value) == 1,
            "of type 'bytes' or 'ByteString' with length 1",
        )
    if field.string_bound:
        bound = field.string_bound
        return (
            lambda value: isinstance(value, str) and len(value) <= bound,
            f"string value not longer than {bound}",
        )
    return (
        lambda value: isinstance(value, element) and _within(value, limits),
        f"of type '{element.__name__}'",
    )


def _many_values(field: Field, element: type) -> tuple[Callable[[Any], bool], str]:
    limits = NO_LIMITS if field.is_message else PRIMITIVES[field.base].limits
    demands = ["a set or sequence"]
    if field.cardinality is Cardinality.ARRAY:
        demands.append(f"with length {field.size}")
    elif field.size:
        demands.append(f"with length <= {field.size}")
    demands.append(f"and each value of type '{element.__name__}'")
    if limits != NO_LIMITS:
        demands.append(_limits_text(PRIMITIVES[field.base]))

    def accepts(values: Any) -> bool:
        return (
            isinstance(values, (Sequence, Set, UserList, array, np.ndarray))
            and not isinstance(values, (str, UserString))
            and (not field.size or _length_fits(field, len(values)))
            and all(isinstance(value, (element, np.generic)) and _within(value, limits) for value in values)
        )

    return accepts, " ".join(demands)


def _length_fits(field: Field, length: int) -> bool:
    return length == field.size if field.cardinality is Cardinality.ARRAY else length <= field.size


def _within(value: Any, limits: tuple[float, float]) -> bool:
    return limits == NO_LIMITS or limits[0] <= value <= limits[1] or not math.isfinite(value)


def _limits_text(primitive: Primitive) -> str:
    low, high = primitive.limits
    if primitive.python is float:
        return f"and each {primitive.idl} in [{low:f}, {high:f}]"
    return f"and each {'integer' if low else 'unsigned integer'} in [{low}, {high}]"
