"""Decode messages from CDR bytes.

The first use of a message type compiles a decoder for it. Each field becomes one line of code, which stores the value
directly in the message's slot. Before the code allocates memory, it checks that enough bytes are available.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from functools import cache
from struct import Struct, calcsize, unpack_from  # noqa: F401  (used by the generated code)
from typing import Any, cast

from numpy import frombuffer  # noqa: F401

from _rosidl.definitions import EMPTY_STRUCTURE_MEMBER, Cardinality, Field, definition
from _rosidl.message import CHECK_FIELDS, Message, message_class  # noqa: F401
from _rosidl.values import PRIMITIVES

HEADER = 4  # bytes that identify the encoding, before the message
ORDERS = {b"\0\0": ">", b"\0\1": "<"}
"""The byte order of numbers in each encoding, in `struct` notation."""
CODES = {name: primitive.code for name, primitive in PRIMITIVES.items()} | {"bool": "?", "byte": "c"}
"""The `struct` codes for the primitives; strings have no code."""

# Each template is code that reads one kind of field from the bytes `data`, at the offset `at` or after the padding that
# follows it: an N-byte number begins at a multiple of N.
COUNT = "at = at + 3 & -4; count, = unpack_uint32(data, at); at += 4; "
ALIGN = "at = at + {pad} & ~{pad}; "
NUMBER = ALIGN + "{target}, = unpack_{base}(data, at); at += {width}"
STRING = COUNT + "{target} = string(data, at, count); at += count"
MESSAGE = "{target}, at = read_{name}(data, at)"
ARRAY = ALIGN + "{target} = frombuffer(data, '{order}{code}', {size}, at).astype('{code}'); at += {size} * {width}"
NUMBERS = COUNT + "{target}, at = numbers(data, at + {pad} & ~{pad} if count else at, '{code}', count)"
OCTETS = COUNT + "{target} = list(unpack_from(f'{{count}}{code}', data, at)); at += count"
ITEMS = COUNT + "{target} = items = []\n for _ in range(count): ONE; items.append(item)"


def decode(data: bytes, message_type: type[Message]) -> Message:
    """Decode CDR bytes into a message, ignoring padding and anything after the last field.

    Raises:
        Exception: the bytes are not a message of this type; the exception can be of any type.
    """
    if (encoding := data[:2]) not in ORDERS or len(data) < HEADER:
        raise ValueError(f"they begin with {data[:HEADER].hex(' ') or 'nothing'}, which is not plain CDR")
    return _decoder(message_type._definition.type_name, ORDERS[encoding])(memoryview(data)[HEADER:], 0)[0]


def string(data: memoryview, at: int, count: int) -> str:
    """Return a string that occupies ``count`` bytes, including its final zero byte."""
    if not 0 < count <= len(data) - at or data[at + count - 1]:
        raise ValueError(f"no string ends after {count} bytes")
    return str(data[at : at + count - 1], "utf-8")


def numbers(data: memoryview, at: int, code: str, count: int) -> tuple[array[Any], int]:
    """Return an array of ``count`` numbers and the offset of its end."""
    values = array(code)
    end = at + count * values.itemsize
    if end > len(data):
        raise ValueError(f"there are fewer than {count} numbers")
    values.frombytes(data[at:end])
    return values, end


@cache
def _decoder(type_name: str, order: str) -> Callable[[memoryview, int], tuple[Message, int]]:
    """Return a function that reads a message of the type and returns the message and the offset of its end."""
    fields = definition(type_name).wire_fields
    names: dict[str, Any] = {**globals(), "Type": message_class(type_name), "new": object.__new__}
    names |= {f"unpack_{base}": Struct(order + code).unpack_from for base, code in CODES.items()}
    names |= {f"read_{field.name}": _decoder(field.base, order) for field in fields if field.is_message}
    begin = "def decode(data, at):\n message = new(Type); message._check_fields = CHECK_FIELDS"
    exec("\n ".join([begin, *(_line(field, order) for field in fields), "return message, at"]), names)
    return cast(Callable[[memoryview, int], tuple[Message, int]], names["decode"])


def _line(field: Field, order: str) -> str:
    """Return the code that reads a field."""
    code = CODES.get(field.base, "")
    line = one = MESSAGE if field.is_message else NUMBER if code else STRING
    if field.cardinality is Cardinality.ARRAY:
        line = ARRAY
    elif field.cardinality is Cardinality.SEQUENCE:
        numbers = OCTETS if code in ("?", "c") else NUMBERS if order == "<" else NUMBERS + "; {target}.byteswap()"
        line = numbers if code else ITEMS.replace("ONE", one.replace("{target}", "item"))
    target = "_" if field.name == EMPTY_STRUCTURE_MEMBER else f"message._{field.name}"
    width = calcsize(f"={code}")
    return line.format(target=target, order=order, code=code, width=width, pad=width - 1, **vars(field))
