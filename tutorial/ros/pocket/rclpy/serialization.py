"""Messages as bytes."""

from _rosidl.message import Message
from rclpy._wire import check_message_type, decode, encode


def serialize_message(message: Message) -> bytes:
    """Return a message as it travels: a CDR header and the fields.

    Raises:
        AttributeError: it is no message.
        TypeError: a field holds what its type cannot.
    """
    check_message_type(type(message))
    return encode(message)


def deserialize_message(serialized_message: bytes, message_type: type[Message]) -> Message:
    """Return the message that the bytes are.

    Raises:
        AttributeError: the type is no message type.
        RCLError: the bytes are no such message.
    """
    check_message_type(message_type)
    return decode(serialized_message, message_type)
