"""Serialize and deserialize messages.

Each message type has a wire type, made from its list of fields. The wire type is announced with each topic, and Cyclone
DDS's codec uses it to read a message's attributes and encode them. Messages are decoded by the faster code in
`_rosidl.cdr`.
"""

from __future__ import annotations

import threading
from functools import cache
from typing import Any, cast

from _rosidl import cdr, values
from _rosidl.definitions import Cardinality, Field, definition
from _rosidl.message import Message
from cyclonedds.idl import make_idl_struct, types
from rclpy._rclpy_pybind11 import RCLError

PRIMITIVES: dict[str, Any] = {name: getattr(types, name) for name, of in values.PRIMITIVES.items() if of.code}
PRIMITIVES |= {"bool": bool, "string": str, "byte": types.array[types.uint8, 1]}
"""The Cyclone DDS types for the primitives. In rclpy, a byte is a ``bytes`` object of length 1; here it is an array of
one uint8."""

_lock = threading.RLock()


def check_message_type(message_type: Any) -> None:
    """Raise an error for anything but a message type.

    Raises:
        AttributeError: the object is not a message type; rclpy raises the same error.
    """
    if not (isinstance(message_type, type) and issubclass(message_type, Message)):
        raise AttributeError(
            f"type object '{type(message_type).__name__}' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 "
            "message type but it should be a ROS 2 message type. Make sure to source your ROS 2 workspace after your "
            "ROS 1 workspace."
        )


def encode(message: Message) -> bytes:
    """Serialize a message, with the four-byte header of little-endian plain CDR.

    Raises:
        AttributeError: a field that must hold a message holds something else; rclpy raises the same exception.
        TypeError: any other field holds a value that does not match its type.
    """
    try:
        return cast(bytes, wire_type(message._definition.type_name, bytes).__idl__.serialize(message))
    except Exception as error:
        causes = [str(error)]
        while error.__cause__ is not None:
            error = error.__cause__  # type: ignore[assignment]
            causes.append(str(error))
        is_no_message = isinstance(error, AttributeError) and error.name != "encode"  # only string fields need `encode`
        kind = AttributeError if is_no_message else TypeError
        raise kind(f"{type(message).__name__} cannot be serialized: {': '.join(causes)}") from error


def decode(data: bytes, message_type: type[Message]) -> Message:
    """Deserialize a message, ignoring padding and anything after the last field.

    Raises:
        RCLError: the bytes are not a message of this type.
    """
    try:
        return cdr.decode(data, message_type)
    except Exception as error:
        raise RCLError(
            f"failed to deserialize ROS message: {len(data)} bytes are not a {message_type.__name__}: {error}"
        ) from error


def wire_name(type_name: str) -> str:
    """Return the type's name on the wire: ``"sensor_msgs::msg::dds_::Joy_"`` for ``"sensor_msgs/msg/Joy"``."""
    package, _, name = type_name.split("/")
    return f"{package}::msg::dds_::{name}_"


@cache
def wire_type(type_name: str, octets: Any) -> Any:
    """Return the Cyclone DDS struct for a message type. If two threads need it at the same time, each may create one.

    Args:
        type_name: the message type.
        octets: the type to use for a sequence of uint8. ``bytes`` has the same form on the wire and avoids
            converting an image to a list of numbers. A topic cannot use ``bytes``, however, because the topic has to
            describe its message type to other programs.
    """
    with _lock:  # make_idl_struct uses a global stack of scopes
        fields = {field.wire_attribute: _idl_type(field, octets) for field in definition(type_name).wire_fields}
        typename = wire_name(type_name)
        made = make_idl_struct(typename.rpartition("::")[2], typename, fields, dataclassify=False)
        made.__idl__.populate()
        return made


def _idl_type(field: Field, octets: Any) -> Any:
    base = wire_type(field.base, octets) if field.is_message else PRIMITIVES[field.base]
    if field.string_bound:
        base = types.bounded_str[field.string_bound]
    if field.cardinality is Cardinality.ARRAY:
        return types.array[base, field.size]
    if field.cardinality is Cardinality.SEQUENCE:
        if base is types.uint8 and not field.size:
            return octets
        return types.sequence[base, field.size] if field.size else types.sequence[base]
    return base
