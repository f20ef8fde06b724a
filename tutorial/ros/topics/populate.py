"""Filling a message with the values that a user wrote, with the checks of ``ros2 topic pub``."""

import re
from array import array
from typing import Any

import numpy as np
import yaml
from rclpy.serialization import serialize_message

from tutorial.errors import TutorialError
from tutorial.ros.topics.names import is_message, message_class


def populated(type_name: str, text: str) -> Any:
    """Make a message and fill it.

    Args:
        type_name: its type, such as ``"sensor_msgs/msg/Joy"``.
        text: the fields' values as YAML: ``"{axes: [0.0, 0.5]}"``.

    Raises:
        TutorialError: there is no such type, the text is no YAML, or not what the message's fields take; in the words
            of ``ros2``.
    """
    try:
        kind = message_class(type_name)
    except TutorialError:
        raise TutorialError("The passed message type is invalid") from None
    try:
        values = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise TutorialError(f"The passed value needs to be in YAML string or a dictionary\n{error}") from error
    if not isinstance(values, dict):
        raise TutorialError("The passed value needs to be a dictionary in YAML format")
    try:
        message = _filled(kind, values)
        serialize_message(message)
    except (ArithmeticError, AssertionError, AttributeError, RuntimeError, TypeError, ValueError) as error:
        raise TutorialError(f"Failed to populate field: {error}") from error
    return message


def _filled(kind: Any, values: Any) -> Any:
    """Make a message, which checks what is assigned, of a dictionary."""
    if not isinstance(values, dict):
        raise _no_dictionary(values)
    message = kind(check_fields=True)
    kinds = message.get_fields_and_field_types()
    for name, value in values.items():
        if name not in kinds:
            raise AttributeError(f"'{kind.__name__}' object has no attribute '{name}'")
        setattr(message, name, _converted(getattr(message, name), kinds[name], value))
    return message


def _converted(old: Any, field_type: str, value: Any) -> Any:
    """Turn a value into what a field's old value is."""
    if found := re.fullmatch(r"(?:sequence<)?(\w+)/(\w+)(?:(?:, \d+)?>|\[\d+\])", field_type):  # of messages
        element = message_class(f"{found[1]}/msg/{found[2]}")
        return [_filled(element, item) for item in value]
    if isinstance(old, array):
        return array(old.typecode, value)
    if isinstance(old, np.ndarray):
        return np.array(value, dtype=old.dtype)
    if is_message(old):
        return _filled(type(old), value)
    try:
        return value if type(value) is type(old) else type(old)(value)
    except TypeError:
        raise _no_dictionary(value) from None


def _no_dictionary(value: Any) -> TypeError:
    return TypeError(f"Value '{value}' is expected to be a dictionary but is a {type(value).__name__}")
