"""Messages as the YAML text that ``ros2 topic echo`` prints."""

from __future__ import annotations

import re
import sys
from array import array
from collections.abc import Sized
from typing import Any

import numpy as np
import yaml

from tutorial.errors import printable
from tutorial.ros.topics.names import is_message

__all__ = ["ARRAYS", "TRUNCATE_LENGTH", "array_summary", "ellipsis", "message_to_yaml"]

TRUNCATE_LENGTH = 128
"""How much of an array or a string ``ros2 topic echo`` prints."""

ARRAYS = (list, tuple, array, np.ndarray)
"""What a field of several values may hold."""


def message_to_yaml(message: Any, truncate_length: int | None = TRUNCATE_LENGTH, no_arr: bool = False) -> str:
    """Write a message as YAML, its fields in their order.

    A string of visible characters and line breaks stands as ``ros2`` writes it. Any other is in double quotes, where
    YAML has the escapes that `tutorial.errors.printable` writes: read again, it is the same string.

    Args:
        message: of any type.
        truncate_length: how many elements of an array and characters of a string are written, followed by ``...``;
            None for all.
        no_arr: write of each array only what it is.

    Returns:
        Lines, of which the last ends in a line break too.
    """
    plain = _plain(message, truncate_length, no_arr)
    text = yaml.dump(
        plain, Dumper=_Dumper, sort_keys=False, allow_unicode=True, default_flow_style=False, width=sys.maxsize
    )
    return "\n".join(map(printable, text.split("\n")))


def array_summary(value: Sized, kind: str) -> str:
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


class _Dumper(yaml.SafeDumper):
    """Puts strings in double quotes that are not all visible."""


def _string(dumper: _Dumper, text: str) -> yaml.ScalarNode:
    style = None if text.replace("\n", "").isprintable() else '"'
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style)


_Dumper.add_representer(str, _string)


def _plain(value: Any, length: int | None, no_arr: bool, kind: str = "") -> Any:
    """Turn a field's value into what YAML knows; as in ROS 2, bytes become a string of their characters."""
    if is_message(value):
        kinds = value.get_fields_and_field_types()
        return {name: _plain(getattr(value, name), length, no_arr, kind) for name, kind in kinds.items()}
    if isinstance(value, bytes):
        value = value.decode("latin-1")
    if isinstance(value, str):
        return "".join([value[:length], *ellipsis(value, length)])
    if isinstance(value, ARRAYS):
        if no_arr and kind:
            return array_summary(value, kind)
        return [_plain(element, length, no_arr) for element in value[:length]] + ellipsis(value, length)
    return value.item() if isinstance(value, np.generic) else value


def ellipsis(value: Sized, length: int | None) -> list[str]:
    """Return what follows the first ``length`` elements or characters: three dots if there are more."""
    return ["..."] if length is not None and len(value) > length else []


def _long(kind: str) -> str:
    """Name a field's type in full: ``"std_msgs/msg/Header"`` for ``"std_msgs/Header"``, no length of a string."""
    return re.sub(r"<\d+>", "", kind).replace("/", "/msg/")
