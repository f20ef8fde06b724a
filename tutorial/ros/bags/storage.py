"""What the two kinds of file that a bag is made of, MCAP and SQLite, have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

__all__ = ["LARGEST_MESSAGE", "Channel", "Damaged", "FileReader", "RawMessage", "Span", "read_yaml"]

LARGEST_MESSAGE = 128 * 2**20
"""Of a message, or of a chunk of messages, when it is unpacked [bytes]: some five pictures of the largest cameras."""

RawMessage = tuple[str, int, bytes]
"""Its topic, when it was received [ns], and its payload."""


class Damaged(Exception):  # noqa: N818 - it describes a file, and is no error of a program
    """Nothing in a file can be read; the text is the end of a sentence."""


@dataclass
class Span:
    """How many messages there are, and when the first and the last of them was received [ns]; 0 without messages."""

    count: int = 0
    start: int = 0
    end: int = 0

    def add(self, count: int, start: int, end: int) -> None:
        """Add some messages."""
        self.start = min(self.start, start) if self.count else start
        self.end = max(self.end, end) if self.count else end
        self.count += count


@dataclass(frozen=True)
class Channel:
    """What a bag holds of a topic, beside its messages.

    Attributes:
        topic: its full name.
        type_name: such as ``"sensor_msgs/msg/Joy"``.
        encoding: of its payloads; ``"cdr"`` in ROS 2.
        qos: what its publishers offered, as YAML.
        definition: the message type's, with those that it is made of, as text; only for writing.
        type_hash: of the message type (REP 2016); only for writing.
    """

    topic: str
    type_name: str
    encoding: str = "cdr"
    qos: str = ""
    definition: str = ""
    type_hash: str = ""


class _Loader(yaml.SafeLoader):
    """Merges no mappings: a few that are merged into each other unfold to gigabytes."""

    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        """Leave a mapping as it is."""


def read_yaml(text: str | bytes) -> Any:
    """Read what a bag has in YAML. PyYAML's faster loader, in C, ends the process on text that is nested too deeply.

    Raises:
        Exception: it is no YAML; whoever wrote it, it may be anything.
    """
    return yaml.load(text, Loader=_Loader)


class FileReader(ABC):
    """Reads one file of a bag, as far as it goes. The file is open only while messages are read.

    Args:
        path: the file.
        say: is called with what is wrong with the file, when it is found; each is the end of a sentence.

    Attributes:
        channels: its topics, by what the file calls them.
        counts: how many messages each topic has.
        span: the number of all its messages, and their times.

    Raises:
        Damaged: it is no such file.
        OSError: it cannot be read.
    """

    def __init__(self, path: Path, say: Callable[[str], object]) -> None:
        self.channels: dict[int, Channel] = {}
        self.counts: Counter[str] = Counter()
        self.span = Span()
        self._path = path
        self._say = say

    @abstractmethod
    def messages(self, topics: Collection[str], since: int) -> Iterator[RawMessage]:
        """Yield the messages of these topics in the order of time, from a time on [ns]."""

    def _count(self, messages: Iterable[RawMessage]) -> None:
        """Count the messages one by one."""
        for topic, time, _ in messages:
            self.span.add(1, time, time)
            self.counts[topic] += 1
