"""Message classes with the same interface as the classes that ROS 2 generates for Python."""

from __future__ import annotations

import os
from array import array
from collections.abc import Callable
from importlib import import_module
from typing import Any, ClassVar, NamedTuple, cast

import numpy as np

from _rosidl.checks import checker
from _rosidl.definitions import Cardinality, Definition, Field, definition
from _rosidl.values import PRIMITIVES, container, default_factory, field_type

CHECK_FIELDS = os.environ.get("ROS_PYTHON_CHECK_FIELDS") == "1"

DEFAULTS = {("geometry_msgs/msg/Quaternion", "w"): 1.0, ("sensor_msgs/msg/NavSatStatus", "status"): -2}
"""The only defaults in the common interfaces that aren't zero; the rosbags library's type store has no defaults."""


class Slot(NamedTuple):
    """Information that a message class stores about one of its fields.

    Attributes:
        name: the field's name.
        size: length of the field's array; 0 if the field is not an array.
        default: returns the field's default value.
        contain: converts a constructor argument to the container to store; None to store the argument unchanged.
        store: stores a value in a message's slot.
    """

    name: str
    size: int
    default: Callable[[], Any]
    contain: Callable[[Any], Any] | None
    store: Callable[[Any, Any], None]


class Message:  # noqa: PLW1641  (mutable, so without a hash)
    """Base class of all messages.

    A message has ``__slots__`` and no ``__dict__``, so assigning to a misspelled field raises an AttributeError.
    As in ROS 2 Jazzy, values are checked only on request, because checking every value takes time.

    Args:
        check_fields: check every value that is assigned; by default, only if ``ROS_PYTHON_CHECK_FIELDS`` is 1.
        **fields: values of fields; omitted fields get their default values.

    Raises:
        AssertionError: an array has the wrong length, or ``check_fields`` is true and an argument is invalid.
    """

    __slots__ = ()

    _definition: ClassVar[Definition]
    _fields_and_field_types: ClassVar[dict[str, str]]
    _slots_: ClassVar[tuple[Slot, ...]]  # can't clash: no field's name ends with "_"
    _check_fields: bool

    structure_needs_at_least_one_member: ClassVar[int] = 0

    def __init__(self, *, check_fields: bool = CHECK_FIELDS, **fields: Any) -> None:
        self._check_fields = check_fields  # type: ignore[misc]  # a slot of the subclass
        if check_fields and (unknown := sorted(fields.keys() - self._fields_and_field_types.keys())):
            raise AssertionError(f"Invalid arguments passed to constructor: {', '.join(unknown)}")
        for slot in self._slots_:
            if slot.name in fields:
                value = fields[slot.name]
                setattr(self, slot.name, slot.contain(value) if slot.contain else value)
                assert not slot.size or getattr(self, slot.name).shape == (slot.size,)
            else:
                slot.store(self, slot.default())

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return the fields' types, keyed by field name: ``{"header": "std_msgs/Header", ...}``."""
        return dict(cls._fields_and_field_types)

    def __repr__(self) -> str:
        package = type(self).__module__.rpartition(".")[0]
        fields = ", ".join(f"{slot.name}={_shown(getattr(self, slot.name))}" for slot in self._slots_)
        return f"{package}.{type(self).__name__}({fields})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return False
        pairs = ((getattr(self, slot.name), getattr(other, slot.name)) for slot in self._slots_)
        return all(np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b for a, b in pairs)


def message_class(type_name: str) -> type[Message]:
    """Return the class for a message type. The class is imported, so that each type has only one class.

    Args:
        type_name: the type's name, such as ``"sensor_msgs/msg/Joy"``.
    """
    package, _, name = type_name.split("/")
    return cast(type[Message], getattr(import_module(f"{package}.msg"), name))


def make_message_class(type_name: str, module: str) -> type[Message]:
    """Create the class for a message type.

    Args:
        type_name: the type's name, such as ``"sensor_msgs/msg/Joy"``.
        module: the name of the module that will contain the class.
    """
    message = definition(type_name)
    name = type_name.rpartition("/")[2]
    namespace: dict[str, Any] = {
        "__module__": module,
        "__doc__": f"Message class '{name}'.",
        "__slots__": [*(f"_{field.name}" for field in message.fields), "_check_fields"],
        "_definition": message,
        "_fields_and_field_types": {field.name: field_type(field) for field in message.fields},
    }
    namespace.update(message.constants)
    constants = {name: property(lambda _, v=v: v) for name, v in message.constants.items()}  # type: ignore[misc]
    shared = {"__module__": module, **constants}
    cls: type[Message] = type(f"Metaclass_{name}", (type,), shared)(name, (Message,), namespace)
    cls._slots_ = tuple(_add_field(cls, field) for field in message.fields)
    return cls


def _add_field(cls: type[Message], field: Field) -> Slot:
    """Add a property for the field to the message class, and return the field's slot."""
    element = message_class(field.base) if field.is_message else PRIMITIVES[field.base].python
    kept = container(field)
    check = checker(field, element)
    slot = getattr(cls, f"_{field.name}")

    def assign(self: Message, value: Any) -> None:
        if self._check_fields:
            check(value)
        if kept and not (self._check_fields and isinstance(value, kept.kind)):  # checked values are not copied
            value = kept.make(value)
        slot.__set__(self, value)

    setattr(cls, field.name, property(slot.__get__, assign, doc=f"Message field '{field.name}'."))
    if field.is_octet_array:
        setattr(cls, field.wire_attribute, property(lambda self: slot.__get__(self).tobytes()))
    default = DEFAULTS.get((cls._definition.type_name, field.name))
    make_default = default_factory(field, element) if default is None else lambda: default
    size = field.size if field.cardinality is Cardinality.ARRAY else 0
    return Slot(field.name, size, make_default, kept and kept.make, slot.__set__)


def _shown(value: Any) -> str:
    if not isinstance(value, array):
        return repr(value)
    return repr(value)[len("array('d', ") : -1] if len(value) else "[]"
