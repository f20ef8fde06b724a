"""Which part of a message ``ros2 topic echo`` shows, and how."""

from __future__ import annotations

from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from tutorial.errors import TutorialError, printable
from tutorial.ros.topics.message_csv import message_to_csv
from tutorial.ros.topics.message_yaml import TRUNCATE_LENGTH, message_to_yaml
from tutorial.ros.topics.names import is_message

__all__ = ["MessageForm"]


@dataclass(frozen=True)
class MessageForm:
    """How a message is written, by the options of ``ros2 topic echo``.

    Attributes:
        field: show only this field, named with those around it: ``"header.stamp"``. None for the whole message.
        csv: write one line with commas instead of YAML.
        truncate_length: how many elements of an array and characters of a string are written; None for all.
        no_arr: write of each array only what it is.

    Raises:
        TutorialError: the field is no name.
    """

    field: str | None = None
    csv: bool = False
    truncate_length: int | None = TRUNCATE_LENGTH
    no_arr: bool = False

    def __post_init__(self) -> None:
        if self.field is not None and not self._path():
            raise TutorialError(f"Invalid field value '{self.field}'")

    def text(self, message: Any) -> str:
        """Write a message, or its field, with what closes it: ``---``, or for CSV nothing but the line's end.

        A field that is no message is written as Python shows it, a string line by line, with what is not visible as
        escapes.

        Raises:
            TutorialError: the message has no such field.
        """
        value = message
        if self.field is not None:
            try:
                value = attrgetter(self._path())(message)
            except AttributeError as error:
                raise TutorialError(f"Invalid field '{self._path()}': {error}") from None
        if isinstance(value, str):
            return "\n".join([*map(printable, value.split("\n")), "---\n"])  # a robot description has many lines
        if not is_message(value):
            return f"{value}\n---\n"
        if self.csv:
            return f"{message_to_csv(value, self.truncate_length, self.no_arr)}\n"
        return f"{message_to_yaml(value, self.truncate_length, self.no_arr)}---\n"

    def _path(self) -> str:
        """The field's name, without dots too many."""
        return ".".join(name for name in (self.field or "").split(".") if name)
