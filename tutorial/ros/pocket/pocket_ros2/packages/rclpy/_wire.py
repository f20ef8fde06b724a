"""From messages to bytes and back.

A message type's wire type, made from its field list, is what topics show to others, and what Cyclone DDS's own codec
encodes by: it reads the attributes of our messages. Decoding is done by code of our own, which is faster.
"""

from __future__ import annotations

import threading
from functools import cache
from typing import Any, ClassVar, Self, cast

import msgspec
from _rosidl import cdr, values
from _rosidl.definitions import Cardinality, Field, definition
from _rosidl.message import Message
from cyclonedds.idl import make_idl_struct, types
from cyclonedds.internal import SampleInfo
from rclpy._rclpy_pybind11 import RCLError

PRIMITIVES: dict[str, Any] = {name: getattr(types, name) for name, of in values.PRIMITIVES.items() if of.code}
PRIMITIVES |= {"bool": bool, "string": str, "byte": types.array[types.uint8, 1]}
"""What Cyclone DDS calls them. A byte is a bytes of length 1 in rclpy, so it is shown as an array of uint8."""

_lock = threading.RLock()


class Payload:
    """CDR bytes on their way in or out of Cyclone DDS, which takes this for one of its own structs.

    So the bytes of a received message are decoded by whoever wants the message, on a thread of their own choice, and
    one that cannot be decoded does not disturb those behind it.
    """

    __slots__ = ("data", "sample_info")

    __idl__: ClassVar[Any]
    __idl_typename__: ClassVar[str]
    sample_info: Any

    def __init__(self, data: bytes) -> None:
        self.data = data

    def serialize(self, use_version_2: bool | None = None) -> bytes:  # noqa: ARG002
        """Give Cyclone DDS the bytes to send."""
        return self.data

    @classmethod
    def deserialize(cls, data: bytes) -> Self:
        """Take the bytes that Cyclone DDS has received."""
        return cls(data)

    deserialize_key = deserialize


SampleInfo.__new__ = staticmethod(msgspec.defstruct("SampleInfo", ["python_class", *SampleInfo.__match_args__]))
# It is made in C now. Cyclone DDS's C makes one for each sample, and crashes if making it raises: as a method in Python
# does where it is interrupted by Ctrl-C.


def check_message_type(message_type: Any) -> None:
    """Refuse what is not a message type.

    Raises:
        AttributeError: as rclpy raises it.
    """
    if not (isinstance(message_type, type) and issubclass(message_type, Message)):
        raise AttributeError(
            f"type object '{type(message_type).__name__}' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 "
            "message type but it should be a ROS 2 message type. Make sure to source your ROS 2 workspace after your "
            "ROS 1 workspace."
        )


def encode(message: Message) -> bytes:
    """Serialise a message, with the four bytes of header that say little-endian plain CDR.

    Raises:
        AttributeError: a field holds something else than the message that belongs there, as rclpy raises it.
        TypeError: a field holds another value that its type cannot.
    """
    try:
        return cast(bytes, _wire_type(message._definition.type_name, bytes).__idl__.serialize(message))
    except Exception as error:
        causes = [str(error)]
        while error.__cause__ is not None:
            error = error.__cause__  # type: ignore[assignment]
            causes.append(str(error))
        is_no_message = isinstance(error, AttributeError) and error.name != "encode"  # which is missing in a string
        kind = AttributeError if is_no_message else TypeError
        raise kind(f"{type(message).__name__} cannot be serialized: {': '.join(causes)}") from error


def decode(data: bytes, message_type: type[Message]) -> Message:
    """Deserialise a message. Padding and what follows the last field are ignored.

    Raises:
        RCLError: the bytes are not such a message.
    """
    try:
        return cdr.decode(data, message_type)
    except Exception as error:
        raise RCLError(
            f"failed to deserialize ROS message: {len(data)} bytes are no {message_type.__name__}: {error}"
        ) from error


@cache
def payload_type(type_name: str) -> type[Payload]:
    """Return the kind of payload that topics of a message type, such as ``"sensor_msgs/msg/Joy"``, carry."""
    wire_type = _wire_type(type_name, types.sequence[types.uint8])
    identity = {"__slots__": (), "__idl__": wire_type.__idl__, "__idl_typename__": wire_type.__idl_typename__}
    return type(f"{wire_type.__name__}Payload", (Payload,), identity)


def wire_name(type_name: str) -> str:
    """Return the type's name on the wire: ``"sensor_msgs::msg::dds_::Joy_"`` for ``"sensor_msgs/msg/Joy"``."""
    package, _, name = type_name.split("/")
    return f"{package}::msg::dds_::{name}_"


@cache
def _wire_type(type_name: str, octets: Any) -> Any:
    """Return Cyclone DDS's struct for a message type; made once, or once by each of two threads.

    Args:
        type_name: of what to encode.
        octets: what a sequence of uint8 is. ``bytes`` is the same on the wire, and an image need not become a list of
            numbers; but a topic describes its type to others, and knows no name for that.
    """
    with _lock:  # make_idl_struct keeps a global stack of scopes
        fields = {field.wire_attribute: _idl_type(field, octets) for field in definition(type_name).wire_fields}
        typename = wire_name(type_name)
        wire_type = make_idl_struct(typename.rpartition("::")[2], typename, fields, dataclassify=False)
        wire_type.__idl__.populate()
        return wire_type


def _idl_type(field: Field, octets: Any) -> Any:
    base = _wire_type(field.base, octets) if field.is_message else PRIMITIVES[field.base]
    if field.string_bound:
        base = types.bounded_str[field.string_bound]
    if field.cardinality is Cardinality.ARRAY:
        return types.array[base, field.size]
    if field.cardinality is Cardinality.SEQUENCE:
        if base is types.uint8 and not field.size:
            return octets
        return types.sequence[base, field.size] if field.size else types.sequence[base]
    return base
