"""What a message consists of, read from rosbags' store of ROS 2 Jazzy message definitions."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from functools import cache
from typing import Any

EMPTY_STRUCTURE_MEMBER = "structure_needs_at_least_one_member"
"""IDL knows no empty struct: an empty message has this uint8 on the wire, and nothing in its class."""


class Cardinality(Enum):
    """How many values a field holds: a fixed number only of numbers, in all messages that there are."""

    SCALAR = "one"
    ARRAY = "a fixed number"
    SEQUENCE = "any number"


@dataclass(frozen=True)
class Field:
    """One field of a message.

    Attributes:
        name: as in the .msg file.
        base: a primitive such as ``"float64"``, or a message such as ``"std_msgs/msg/Header"``.
        cardinality: one value, a fixed number, or any number.
        size: length of an array, longest length of a sequence (0: unbounded).
        string_bound: longest length of a string (0: unbounded).
    """

    name: str
    base: str
    cardinality: Cardinality = Cardinality.SCALAR
    size: int = 0
    string_bound: int = 0

    @property
    def is_message(self) -> bool:
        """Whether the field holds other messages."""
        return "/" in self.base

    @property
    def is_octet_array(self) -> bool:
        """Whether the field is a fixed number of uint8: numpy for the program, bytes for the wire."""
        return self.cardinality is Cardinality.ARRAY and self.base == "uint8"

    @property
    def wire_attribute(self) -> str:
        """Name of the message's attribute that has the field as Cyclone DDS wants it for encoding."""
        return f"_{self.name}_octets" if self.is_octet_array else self.name


@dataclass(frozen=True)
class Definition:
    """One message type: its constants by name, and its fields as they are on the wire."""

    type_name: str
    constants: dict[str, Any]
    wire_fields: tuple[Field, ...]

    @property
    def fields(self) -> tuple[Field, ...]:
        """The fields that a program sees."""
        return tuple(field for field in self.wire_fields if field.name != EMPTY_STRUCTURE_MEMBER)


@cache
def definition(type_name: str) -> Definition:
    """Look a message type up.

    Args:
        type_name: such as ``"sensor_msgs/msg/Joy"``.

    Raises:
        KeyError: ROS 2 Jazzy's common interfaces have no such message.
    """
    constants, fields = _store().fielddefs[type_name]
    return Definition(
        type_name,
        {name: bytes([int(value)]) if base == "byte" else value for name, base, value in constants},
        tuple(_field(name, description) for name, description in fields),
    )


@cache
def type_hash(type_name: str) -> str:
    """Return the type's hash (REP 2016), such as ``"RIHS01_a13e..."``; endpoints announce it."""
    return str(_store().hash_rihs01(type_name))


@cache
def type_names() -> dict[str, tuple[str, ...]]:
    """Return the names of all messages by package: ``{"sensor_msgs": ("BatteryState", ...), ...}``."""
    packages: dict[str, list[str]] = {}
    for type_name in _store().fielddefs:
        package, _, name = type_name.split("/")
        packages.setdefault(package, []).append(name)
    return {package: tuple(sorted(names)) for package, names in packages.items()}


@cache
def _store() -> Any:
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415  (0.1 s, not spent by `import tutorial`)

    store = get_typestore(Stores.ROS2_JAZZY)
    for constants, fields in store.fielddefs.values():
        fields[:] = [(name, _without_char(description)) for name, description in fields]
        constants[:] = [(name, "uint8" if base == "char" else base, value) for name, base, value in constants]
    return store


def _without_char(description: Any) -> Any:
    """Replace the .msg type char by what ROS 2 makes of it, a uint8: in its class, on the wire and in its hash."""
    if description == ("char", 0):
        return ("uint8", 0)
    if isinstance(description, tuple):
        return tuple(_without_char(part) for part in description)
    return description


def _field(name: str, description: Any) -> Field:
    kind, detail = description
    if kind.name == "BASE":
        base, bound = detail
        return Field(name, base, string_bound=bound)
    if kind.name == "NAME":
        return Field(name, detail)
    element, size = detail
    inner = _field(name, element)
    return Field(name, inner.base, Cardinality[kind.name], size, inner.string_bound)
