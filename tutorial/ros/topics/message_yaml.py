"""Messages as the YAML text that ``ros2 topic echo`` prints."""

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
"""How much of an array or a string ``ros2 topic echo`` prints."""

ARRAYS = (list, tuple, array, np.ndarray)
"""What a field of several values may hold."""


def message_to_yaml(message: Any, no_arr: bool = False) -> str:
    """Write a message as YAML, its fields in their order.

    Of an array or a string no more than 128 elements or characters are written, followed by ``...``. A string of
    visible characters and line breaks stands as ``ros2`` writes it. Any other is in double quotes, where YAML has the
    escapes that `tutorial.errors.printable` writes: read again, it is the same string.

    Args:
        message: of any type.
        no_arr: write of each array only what it is.

    Returns:
        Lines, of which the last ends in a line break too.
    """
    plain = _plain(message, no_arr)
    text = yaml.dump(
        plain, Dumper=_Dumper, sort_keys=False, allow_unicode=True, default_flow_style=False, width=sys.maxsize
    )
    return "\n".join(map(printable, text.split("\n")))


def field_text(message: Any, field: str | None = None, no_arr: bool = False) -> str:
    """Write a message, or a field of it, as ``ros2 topic echo``, with the closing ``---``.

    A field that is no message is written as Python shows it, a string line by line, with what is not visible as
    escapes.

    Args:
        message: of any type.
        field: its name with those around it, such as ``"header.stamp"``; None for the whole message.
        no_arr: write of each array only what it is.

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
    """Puts strings in double quotes that are not all visible."""


def _string(dumper: _Dumper, text: str) -> yaml.ScalarNode:
    style = None if text.replace("\n", "").isprintable() else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_Dumper.add_representer(str, _string)


def _plain(value: Any, no_arr: bool, kind: str = "") -> Any:
    """Turn a field's value into what YAML knows; as in ROS 2, bytes become a string of their characters."""
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
    """Name a field's type in full: ``"std_msgs/msg/Header"`` for ``"std_msgs/Header"``, no length of a string."""
    return re.sub(r"<\d+>", "", kind).replace("/", "/msg/")


def _array_summary(value: Sized, kind: str) -> str:
    """Say of an array only what it is, as ``ros2 topic echo --no-arr``.

    Args:
        value: the array.
        kind: its field's type, such as ``"sequence<double>"``.

    Returns:
        For instance ``"<sequence type: double, length: 2>"``.
    """
    found = re.fullmatch(r"sequence<(\S+?)(?:, (\d+))?>", kind)
    if found is None:
        return f"<array type: {_long(kind)}>"
    element, bound = found.groups()
    return f"<sequence type: {_long(element)}{f'[{bound}]' if bound else ''}, length: {len(value)}>"
