"""Messages as the comma-separated line that ``ros2 topic echo --csv`` prints."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import dropwhile
from operator import not_
from typing import Any

from tutorial.errors import printable
from tutorial.ros.topics.message_yaml import ARRAYS, TRUNCATE_LENGTH, array_summary, ellipsis
from tutorial.ros.topics.names import is_message

__all__ = ["message_to_csv"]


def message_to_csv(message: Any, truncate_length: int | None = TRUNCATE_LENGTH, no_arr: bool = False) -> str:
    """Write all values of a message in the order of their fields, those of messages in it too, with commas between.

    It is one line, whatever is in the message: a line break is an escape, as all that is not visible.

    Args:
        message: of any type.
        truncate_length: how many elements of an array and characters of a string are written, followed by ``...``;
            None for all.
        no_arr: write of each array only what it is.
    """
    kinds = message.get_fields_and_field_types()
    return _joined(_text(getattr(message, name), truncate_length, no_arr, kind) for name, kind in kinds.items())


def _text(value: Any, length: int | None, no_arr: bool, kind: str = "") -> str:
    if is_message(value):
        return message_to_csv(value, length, no_arr)
    if isinstance(value, ARRAYS):
        if no_arr and kind:
            return array_summary(value, kind)
        return _joined([_text(element, length, no_arr) for element in value[:length]] + ellipsis(value, length))
    if isinstance(value, str):
        return "".join([printable(value[:length]), *ellipsis(value, length)])
    return str(value)


def _joined(texts: Iterable[str]) -> str:
    """Join texts as ROS 2 does: no comma follows what is empty so far."""
    return ",".join(dropwhile(not_, texts))
