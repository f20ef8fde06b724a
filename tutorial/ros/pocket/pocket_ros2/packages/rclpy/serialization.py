"""Serialize and deserialize messages."""

from _rosidl.message import Message
from rclpy._wire import check_message_type, decode, encode


def serialize_message(message: Message) -> bytes:
    """Return a message as CDR bytes, including the CDR header.

    Raises:
        AttributeError: the argument is not a message.
        TypeError: a field holds a value that does not match its type.
    """
    check_message_type(type(message))
    return encode(message)


def deserialize_message(serialized_message: bytes, message_type: type[Message]) -> Message:
    """Create a message from CDR bytes.

    Raises:
        AttributeError: the type is not a message type.
        RCLError: the bytes are not a message of this type.
    """
    check_message_type(message_type)
    return decode(serialized_message, message_type)
