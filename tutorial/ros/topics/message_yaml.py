"""Write messages as the YAML text that ``ros2 topic echo`` prints."""

import re
import sys
from array import array
from collections.abc import Sized
from operator import attrgetter
from typing import Any

import numpy as np
import yaml

from tutorial.errors import TutorialError, printable
from tutorial.ros.topics.names import is_message

TRUNCATE_LENGTH = 128
"""Maximum number of elements of an array, or characters of a string, that ``ros2 topic echo`` prints."""

ARRAYS = (list, tuple, array, np.ndarray)
"""Python types of array fields."""


def message_to_yaml(message: Any, no_arr: bool = False) -> str:
    """Write a message as YAML, with its fields in order.

    An array is truncated to 128 elements and a string to 128 characters, and ``...`` is added. A string of visible
    characters and line breaks is written as ``ros2`` writes it. Any other string is written in double quotes, in which
    the escapes used by `tutorial.errors.printable` are valid YAML, so a YAML parser returns the same string.

    Args:
        message: a message of any type.
        no_arr: write only the type and length of each array.

    Returns:
        Lines that each end in a line break, including the last line.
    """
    plain = _plain(message, no_arr)
    text = yaml.dump(
        plain, Dumper=_Dumper, sort_keys=False, allow_unicode=True, default_flow_style=False, width=sys.maxsize
    )
    return "\n".join(map(printable, text.split("\n")))


def field_text(message: Any, field: str | None = None, no_arr: bool = False) -> str:
    """Write a message, or a field of it, as ``ros2 topic echo`` does, including the closing ``---``.

    A field that is not a message is written as Python prints it. A string is written line by line, with escapes for
    invisible characters.

    Args:
        message: a message of any type.
        field: the field's dotted name, such as ``"header.stamp"``; None for the whole message.
        no_arr: write only the type and length of each array.

    Raises:
        TutorialError: the message has no such field.
    """
    try:
        value = message if field is None else attrgetter(field)(message)
    except AttributeError as error:
        raise TutorialError(f"Invalid field '{field}': {error}") from None
    if isinstance(value, str):
        return "\n".join([*map(printable, value.split("\n")), "---\n"])  # a robot description has many lines
    return f"{message_to_yaml(value, no_arr)}---\n" if is_message(value) else f"{value}\n---\n"


class _Dumper(yaml.SafeDumper):
    """Writes a string in double quotes if it contains invisible characters."""


def _string(dumper: _Dumper, text: str) -> yaml.ScalarNode:
    style = None if text.replace("\n", "").isprintable() else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_Dumper.add_representer(str, _string)


def _plain(value: Any, no_arr: bool, kind: str = "") -> Any:
    """Convert a field's value to types that YAML supports; as in ROS 2, bytes become a string."""
    if is_message(value):
        kinds = value.get_fields_and_field_types()
        return {name: _plain(getattr(value, name), no_arr, kind) for name, kind in kinds.items()}
    if isinstance(value, bytes):
        value = value.decode("latin-1")
    if isinstance(value, str):
        return "".join([value[:TRUNCATE_LENGTH], *_ellipsis(value)])
    if isinstance(value, ARRAYS):
        if no_arr and kind:
            return _array_summary(value, kind)
        return [_plain(element, no_arr) for element in value[:TRUNCATE_LENGTH]] + _ellipsis(value)
    return value.item() if isinstance(value, np.generic) else value


def _ellipsis(value: Sized) -> list[str]:
    return ["..."] if len(value) > TRUNCATE_LENGTH else []


def _long(kind: str) -> str:
    """Return a field type's full name, without string lengths: ``"std_msgs/msg/Header"`` for ``"std_msgs/Header"``."""
    return re.sub(r"<\d+>", "", kind).replace("/", "/msg/")


def _array_summary(value: Sized, kind: str) -> str:
    """Describe an array as ``ros2 topic echo --no-arr`` does.

    Args:
        value: the array.
        kind: the field's type, such as ``"sequence<double>"``.

    Returns:
        Text such as ``"<sequence type: double, length: 2>"``.
    """
    found = re.fullmatch(r"sequence<(\S+?)(?:, (\d+))?>", kind)
    if found is None:
        return f"<array type: {_long(kind)}>"
    element, bound = found.groups()
    return f"<sequence type: {_long(element)}{f'[{bound}]' if bound else ''}, length: {len(value)}>"
