"""Check values as the ROS 2 message classes do, with the same error messages."""

from collections import UserString
from collections.abc import Callable, Iterator, Sequence, Set
from typing import Any

import numpy as np

from _rosidl.definitions import Cardinality, Field
from _rosidl.values import Container, container, number_type

Check = tuple[Callable[[Any], bool], str]
"""A function that returns whether a value is valid, and the error message for an invalid value."""


def checker(field: Field, element: type) -> Callable[[Any], None]:
    """Return a function that raises an AssertionError if a value is not valid for a field.

    Args:
        field: the field.
        element: the message class or Python type of the field's values.
    """
    checks = list(_one(field, element) if field.cardinality is Cardinality.SCALAR else [_many(field, element)])
    kept = container(field)
    checks_of_container = list(_kept(field, kept)) if kept else checks

    def check(value: Any) -> None:
        for accepts, demand in checks_of_container if kept and isinstance(value, kept.kind) else checks:
            if not accepts(value):
                raise AssertionError(f"The '{field.name}' {demand}")

    return check


def _one(field: Field, element: type) -> Iterator[Check]:
    if field.is_message:
        yield lambda value: isinstance(value, element), f"field must be a sub message of type '{element.__name__}'"
    elif element is bytes:
        demand = "field must be of type 'bytes' or 'ByteString' with length 1"
        yield lambda value: isinstance(value, (bytes, bytearray)) and len(value) == 1, demand
    elif bound := field.string_bound:
        demand = f"field must be string value not longer than {bound}"
        yield lambda value: isinstance(value, (str, UserString)) and len(value) <= bound, demand
    else:
        yield lambda value: isinstance(value, element), f"field must be of type '{element.__name__}'"
    if number := number_type(field):
        article, (low, high) = "a" if element is float else "an", number.limits
        yield number.holds, f"field must be {article} {number.kind} in [{low}, {high}]"


def _many(field: Field, element: type) -> Check:
    number, fixed = number_type(field), field.cardinality is Cardinality.ARRAY
    demand = "field must be a set or sequence"
    if field.size:
        demand += f" with length {'' if fixed else '<= '}{field.size}"
    demand += f" and each value of type '{element.__name__}'"
    if number:
        limits = "[%f, %f]" if element is float else "[%d, %d]"
        demand += f" and each {number.kind} in {limits % number.limits}"

    def accepts(values: Any) -> bool:
        return (
            isinstance(values, (Sequence, Set))
            and not isinstance(values, (str, UserString))
            and (not field.size or len(values) == field.size or (len(values) < field.size and not fixed))
            and all(isinstance(value, element) and (not number or number.holds(value)) for value in values)
        )

    return accepts, demand


def _kept(field: Field, kept: Container) -> Iterator[Check]:
    """Yield the checks for a value that is already in the field's container, so its numbers are valid."""
    default = kept.default()
    if isinstance(default, np.ndarray):
        dtype = default.dtype
        yield lambda value: bool(value.dtype == dtype), f"numpy.ndarray() must have the dtype of 'numpy.{dtype}'"
        yield lambda value: bool(value.size == field.size), f"numpy.ndarray() must have a size of {field.size}"
    else:
        code = default.typecode
        yield lambda value: bool(value.typecode == code), f"array.array() must have the type code of '{code}'"
        if field.size:
            yield lambda value: len(value) <= field.size, f"array.array() must have a size <= {field.size}"
