"""Fill a message with the values that a user wrote, and check them as ``ros2 topic pub`` does."""

import re
from array import array
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import yaml
from builtin_interfaces.msg import Time
from rclpy.serialization import serialize_message
from std_msgs.msg import Header

from tutorial.errors import TutorialError
from tutorial.ros.topics.names import is_message, message_class

Stamper = Callable[[Time], None]
"""A function that sets one field of a message to a given time."""


class Populated(NamedTuple):
    """A message filled with a user's values.

    Attributes:
        message: the message.
        stampers: functions that each set one field to the time of publication.
    """

    message: Any
    stampers: Sequence[Stamper] = ()

    def stamp(self, now: Time) -> None:
        """Set the fields that hold the time of publication."""
        for set_field in self.stampers:
            set_field(now)


def populated(type_name: str, text: str) -> Populated:
    """Make a message and fill it with values.

    As in ``ros2 topic pub``, a header can be ``auto``, and a stamp can be ``now``: both are set to the time of
    publication.

    Args:
        type_name: the message's type, such as ``"sensor_msgs/msg/Joy"``, or the short form ``"sensor_msgs/Joy"``.
        text: the fields' values as YAML: ``"{header: auto, axes: [0.0, 0.5]}"``.

    Raises:
        TutorialError: there is no such type, the text is not valid YAML, or a value does not fit its field; the error
            text is the same as in ``ros2``.
    """
    try:
        kind = message_class(type_name)
    except TutorialError:
        raise TutorialError("The passed message type is invalid") from None
    values = _parsed(text)
    if not isinstance(values, dict):
        raise TutorialError("The passed value needs to be a dictionary in YAML format")
    stampers: list[Stamper] = []
    return Populated(_checked(kind, values, stampers), stampers)


def populated_request(service: Any, text: str) -> Any:
    """Create a request for a service, and fill it with values.

    Args:
        service: the class of the service type, such as ``std_srvs.srv.SetBool``.
        text: the fields' values as YAML: ``"{data: true}"``.

    Raises:
        TutorialError: the text is not valid YAML, or a value does not fit its field; the error text is the same as in
            ``ros2``.
    """
    return _checked(service.Request, _parsed(text), None)


def _parsed(text: str) -> Any:
    try:
        return yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise TutorialError(f"The passed value needs to be in YAML string or a dictionary\n{error}") from error


def _checked(kind: Any, values: Any, stampers: list[Stamper] | None) -> Any:
    """Create a message, and check that it can be sent.

    Raises:
        TutorialError: a value does not fit its field.
    """
    try:
        message = _filled(kind, values, stampers)
        serialize_message(message)
    except (ArithmeticError, AssertionError, AttributeError, RuntimeError, TypeError, ValueError) as error:
        raise TutorialError(f"Failed to populate field: {error}") from error
    return message


def _filled(kind: Any, values: Any, stampers: list[Stamper] | None) -> Any:
    """Make a message from a dictionary, and append to ``stampers`` the functions that set its stamps.

    The message class itself checks the values. If ``stampers`` is None, the abbreviations for stamps are not accepted.
    """
    if not isinstance(values, dict):
        raise _no_dictionary(values)
    message = kind(check_fields=True)
    kinds = message.get_fields_and_field_types()
    for name, value in values.items():
        if name not in kinds:
            raise AttributeError(f"'{kind.__name__}' object has no attribute '{name}'")
        old = getattr(message, name)
        if stampers is not None and isinstance(old, Header) and value == "auto":
            stampers.append(partial(setattr, old, "stamp"))
        elif stampers is not None and isinstance(old, Time) and value == "now":
            stampers.append(partial(setattr, message, name))
        else:
            setattr(message, name, _converted(old, kinds[name], value, stampers))
    return message


def _converted(old: Any, field_type: str, value: Any, stampers: list[Stamper] | None) -> Any:
    """Convert a value to the type of a field's old value; append to ``stampers`` the functions that set its stamps."""
    if found := re.fullmatch(r"(?:sequence<)?(\w+)/(\w+)(?:(?:, \d+)?>|\[\d+\])", field_type):  # of messages
        element = message_class(f"{found[1]}/msg/{found[2]}")
        return [_filled(element, item, stampers) for item in value]
    if isinstance(old, array):
        return array(old.typecode, value)
    if isinstance(old, np.ndarray):
        return np.array(value, dtype=old.dtype)
    if is_message(old):
        return _filled(type(old), value, stampers)
    try:
        return value if type(value) is type(old) else type(old)(value)
    except TypeError:
        raise _no_dictionary(value) from None


def _no_dictionary(value: Any) -> TypeError:
    return TypeError(f"Value '{value}' is expected to be a dictionary but is a {type(value).__name__}")
