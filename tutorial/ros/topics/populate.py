"""Filling a message with the values that a user wrote, with the checks of ``ros2 topic pub``."""

from __future__ import annotations

import re
from array import array
from typing import Any

import numpy as np
import yaml
from rclpy.serialization import serialize_message

from tutorial.errors import TutorialError
from tutorial.ros.topics.names import is_message, message_class

__all__ = ["passed_class", "populated"]


def passed_class(type_name: str) -> Any:
    """Return the class of a message type that a user named, in full or without ``msg``.

    Args:
        type_name: such as ``"std_msgs/msg/String"``, or ``"std_msgs/String"``.

    Raises:
        TutorialError: there is none; the text is that of ``ros2``.
    """
    try:
        return message_class(re.sub(r"^([^/]+)/([^/]+)$", r"\1/msg/\2", type_name))
    except TutorialError:
        raise TutorialError("The passed message type is invalid") from None


def populated(kind: Any, text: str) -> Any:
    """Make a message and fill it.

    Args:
        kind: its class.
        text: the fields' values as YAML: ``"{axes: [0.0, 0.5]}"``.

    Raises:
        TutorialError: that is no YAML, or not what the message's fields take; the text is that of ``ros2``.
    """
    try:
        values = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise TutorialError(f"The passed value needs to be in YAML string or a dictionary\n{error}") from error
    if not isinstance(values, dict):
        raise TutorialError("The passed value needs to be a dictionary in YAML format")
    message = _empty(kind)
    try:
        _fill(message, values)
        serialize_message(message)
    except (ArithmeticError, AssertionError, AttributeError, RuntimeError, TypeError, ValueError) as error:
        raise TutorialError(f"Failed to populate field: {error}") from error
    return message


def _fill(target: Any, values: Any) -> None:
    """Assign each value to its field."""
    if not isinstance(values, dict):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    kinds = target.get_fields_and_field_types() if is_message(target) else {}
    for name, value in values.items():
        if name not in kinds:
            raise AttributeError(f"'{type(target).__name__}' object has no attribute '{name}'")
        old = getattr(target, name)
        if (element := _element(kinds[name])) is not None:
            setattr(target, name, [_filled(element, item) for item in value])
        else:
            setattr(target, name, _converted(old, value))


def _converted(old: Any, value: Any) -> Any:
    """Turn a value into what a field's old value is."""
    kind = type(old)
    if isinstance(old, array):
        return array(old.typecode, value)
    if isinstance(old, np.ndarray):
        return np.array(value, dtype=old.dtype)
    if type(value) is kind:
        return value
    if is_message(kind):
        return _filled(kind, value)
    try:
        return kind(value)
    except TypeError:
        return _filled(kind, value)


def _filled(kind: Any, values: Any) -> Any:
    made = _empty(kind)
    _fill(made, values)
    return made


def _empty(kind: Any) -> Any:
    """Make a message that checks what is assigned, or the empty value of a type."""
    return kind(check_fields=True) if is_message(kind) else kind()


def _element(field_type: str) -> Any:
    """Return the class of the messages that an array holds; None for any other field."""
    found = re.fullmatch(r"(?:sequence<)?(\w+)/(\w+)(?:(?:, \d+)?>|\[\d+\])", field_type)
    return message_class(f"{found[1]}/msg/{found[2]}") if found else None
