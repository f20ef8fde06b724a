"""Messages as the YAML text that ``ros2 topic echo`` prints."""

from __future__ import annotations

import sys
from array import array
from typing import Any

import numpy as np
import yaml

from tutorial.errors import TutorialError

__all__ = ["TRUNCATE_LENGTH", "field_text", "message_to_yaml"]

TRUNCATE_LENGTH = 128
"""How much of an array or a string ``ros2 topic echo`` prints."""


def message_to_yaml(message: Any, truncate_length: int | None = TRUNCATE_LENGTH) -> str:
    """Write a message as YAML, its fields in their order.

    Args:
        message: of any type.
        truncate_length: how many elements of an array and characters of a string are written, followed by ``...``;
            None for all.

    Returns:
        Lines, of which the last ends in a line break too.
    """
    text: str = yaml.dump(
        _plain(message, truncate_length),
        Dumper=yaml.SafeDumper,
        sort_keys=False,
        allow_unicode=True,
        default_flow_style=False,
        width=sys.maxsize,
    )
    return text


def field_text(message: Any, field: str | None = None) -> str:
    """Write a message, or one field of it, as ``ros2 topic echo --field`` does, without the closing ``---``.

    A field that is a message is written as YAML, any other as Python shows it.

    Args:
        message: of any type.
        field: its name, with those of the fields around it: ``"header.stamp"``. None for the whole message.

    Raises:
        TutorialError: there is no such field.
    """
    names = [name for name in (field or "").split(".") if name]
    if field is not None and not names:
        raise TutorialError(f"Invalid field value '{field}'")
    value = message
    for name in names:
        try:
            value = getattr(value, name)
        except AttributeError as error:
            raise TutorialError(f"Invalid field '{'.'.join(names)}': {error}") from None
    return message_to_yaml(value) if _is_message(value) else f"{value}\n"


def _is_message(value: Any) -> bool:
    return hasattr(value, "get_fields_and_field_types")


def _plain(value: Any, length: int | None) -> Any:
    """Turn a field's value into what YAML knows; as in ROS 2, bytes become a string of their characters."""
    if _is_message(value):
        return {name: _plain(getattr(value, name), length) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes):
        value = value.decode("latin-1")
    if isinstance(value, str):
        return value if length is None or len(value) <= length else f"{value[:length]}..."
    if isinstance(value, (list, tuple, array, np.ndarray)):
        end = [] if length is None or len(value) <= length else ["..."]
        return [_plain(element, length) for element in value[:length]] + end
    return value.item() if isinstance(value, np.generic) else value
