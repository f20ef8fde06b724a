"""Definitions of the messages in ROS 2 Jazzy's common interfaces.

The definitions are in ``jazzy.json``, which the tests' ``support/record_definitions.py`` generates from the type store
of the package rosbags. Loading the type store itself would take 0.1 s in every program, because it creates the message
classes of all ROS 2 distributions up to Jazzy.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any

RECORDED = Path(__file__).with_name("jazzy.json")
"""The hash, constants and fields of each type, by name. Types of constants and fields are written as in .msg files."""

FIELD_TYPE = re.compile(
    r"(?P<base>[\w/]+)(<=(?P<string_bound>\d+))?(?P<array>\[(?P<fixed>\d+)\])?(?P<sequence>\[(<=(?P<most>\d+))?\])?"
)

EMPTY_STRUCTURE_MEMBER = "structure_needs_at_least_one_member"
"""An empty message has this uint8 on the wire, because IDL has no empty structs. The message class omits the field."""


class Cardinality(Enum):
    """How many values a field holds. In the common interfaces, only arrays of numbers have a fixed length."""

    SCALAR = "one"
    ARRAY = "a fixed number"
    SEQUENCE = "any number"


@dataclass(frozen=True)
class Field:
    """One field of a message.

    Attributes:
        name: the field's name in the .msg file.
        base: a primitive such as ``"float64"``, or a message such as ``"std_msgs/msg/Header"``.
        cardinality: whether the field holds one value, a fixed number of values, or any number of values.
        size: length of an array, or maximum length of a sequence (0: unbounded).
        string_bound: maximum length of a string (0: unbounded).
    """

    name: str
    base: str
    cardinality: Cardinality = Cardinality.SCALAR
    size: int = 0
    string_bound: int = 0

    @property
    def is_message(self) -> bool:
        """Whether the field holds messages."""
        return "/" in self.base

    @property
    def is_octet_array(self) -> bool:
        """Whether the field is a fixed-size array of uint8: a numpy array in programs, but bytes on the wire."""
        return self.cardinality is Cardinality.ARRAY and self.base == "uint8"

    @property
    def wire_attribute(self) -> str:
        """Name of the attribute that holds the field's value in the form that Cyclone DDS can encode."""
        return f"_{self.name}_octets" if self.is_octet_array else self.name


@dataclass(frozen=True)
class Definition:
    """One message type: its constants by name, and its fields in their order on the wire."""

    type_name: str
    constants: dict[str, Any]
    wire_fields: tuple[Field, ...]

    @property
    def fields(self) -> tuple[Field, ...]:
        """All fields except the placeholder in an empty message, which the message class omits."""
        return tuple(field for field in self.wire_fields if field.name != EMPTY_STRUCTURE_MEMBER)


@cache
def definition(type_name: str) -> Definition:
    """Look up a message type.

    Args:
        type_name: the type's name, such as ``"sensor_msgs/msg/Joy"``.

    Raises:
        KeyError: ROS 2 Jazzy's common interfaces have no such message.
    """
    recorded = _recorded()[type_name]
    return Definition(
        type_name,
        {name: bytes([value]) if base == "byte" else value for name, (base, value) in recorded["constants"].items()},
        tuple(_field(name, written) for name, written in recorded["fields"].items()),
    )


@cache
def type_hash(type_name: str) -> str:
    """Return the type's hash (REP 2016), such as ``"RIHS01_a13e..."``; endpoints announce it."""
    return str(_recorded()[type_name]["hash"])


@cache
def type_names() -> dict[str, tuple[str, ...]]:
    """Return the names of all messages, grouped by package: ``{"sensor_msgs": ("BatteryState", ...), ...}``."""
    packages: dict[str, list[str]] = {}
    for type_name in _recorded():
        package, _, name = type_name.split("/")
        packages.setdefault(package, []).append(name)
    return {package: tuple(sorted(names)) for package, names in packages.items()}


@cache
def _recorded() -> dict[str, dict[str, Any]]:
    return dict(json.loads(RECORDED.read_text(encoding="utf-8")))


def _field(name: str, written: str) -> Field:
    """Parse a field's type, such as ``"float64[36]"``, ``"std_msgs/msg/Header"`` or ``"string<=255[]"``."""
    found = FIELD_TYPE.fullmatch(written)
    assert found is not None, written
    kind = Cardinality.ARRAY if found["array"] else Cardinality.SEQUENCE if found["sequence"] else Cardinality.SCALAR
    return Field(name, found["base"], kind, int(found["fixed"] or found["most"] or 0), int(found["string_bound"] or 0))
