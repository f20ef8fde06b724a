"""What the two kinds of file that a bag is made of, MCAP and SQLite, have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

__all__ = [
    "LARGEST_MESSAGE",
    "LONGEST_NAME",
    "LONGEST_QOS",
    "MOST_FAULTS",
    "MOST_TOPICS",
    "SUFFIXES",
    "Channel",
    "Damaged",
    "FileReader",
    "FileWriter",
    "RawMessage",
]

SUFFIXES = {"mcap": ".mcap", "sqlite3": ".db3"}
"""Of the files, by the name that ``ros2 bag`` has for a kind of storage."""

LARGEST_MESSAGE = 128 * 2**20
"""Of a message, or of a chunk of messages, when it is unpacked [bytes]: some five pictures of the largest cameras."""

MOST_TOPICS = 1000
"""Of a bag. A robot has a hundred."""

LONGEST_NAME = 1000
"""Of a topic or a type [characters]; in ROS 2 they have 255."""

LONGEST_QOS = 2**16
"""Of what the publishers of a topic offered [characters]: some two hundred of them."""

MOST_FAULTS = 5
"""Of a file or a bag, that are told of."""

RawMessage = tuple[int, int, bytes]
"""The id of its channel, when it was received [ns], and its payload."""


class Damaged(Exception):  # noqa: N818 - it says what is the case, and is no error of anybody's program
    """From here on a file is not what it ought to be; the text is the end of a sentence."""


@dataclass(frozen=True)
class Channel:
    """A topic in a file.

    Attributes:
        id: what the file calls it.
        topic: its full name.
        type_name: such as ``"sensor_msgs/msg/Joy"``.
        encoding: of its payloads; ``"cdr"`` in ROS 2.
        qos: what its publishers offered, as YAML.
        definition: the message type's, with those that it is made of, as text; empty where it was read, not written.
        type_hash: of the message type (REP 2016).
    """

    id: int
    topic: str
    type_name: str
    encoding: str = "cdr"
    qos: str = ""
    definition: str = ""
    type_hash: str = ""


class FileWriter(Protocol):
    """Writes one file of a bag."""

    def add_channel(self, channel: Channel) -> None:
        """Make a topic known before its first message."""

    def write(self, channel_id: int, received_ns: int, sent_ns: int, payload: bytes) -> None:
        """Write a message."""

    def flush(self) -> None:
        """Give what is written to the operating system: it outlives this process."""

    def close(self, metadata: str) -> None:
        """Complete the file.

        Args:
            metadata: of the bag, so far, as YAML.
        """


class FileReader(ABC):
    """Reads one file of a bag, as far as it goes.

    Args:
        path: the file.

    Attributes:
        path: the same.
        channels: its topics by id.
        counts: how many messages each has, by id.
        start, end: when its first and its last message was received [ns]; 0 where there are none.
        faults: what is wrong with the file, as far as it was read, each the end of a sentence.

    Raises:
        Damaged: it is no such file.
        OSError: it cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.channels: dict[int, Channel] = {}
        self.counts: Counter[int] = Counter()
        self.start = self.end = 0
        self.faults: list[str] = []

    @abstractmethod
    def messages(self, wanted: Collection[int], since: int) -> Iterator[RawMessage]:
        """Yield the messages of these channels in the order of time, from a time on [ns]."""

    @abstractmethod
    def close(self) -> None:
        """Close the file. Idempotent."""

    def _say(self, fault: str) -> None:
        if fault not in self.faults and len(self.faults) < MOST_FAULTS:
            self.faults.append(fault)

    def _learn(self, channel: Channel) -> None:
        """Add a topic, or what a later record says of it."""
        if channel.id in self.channels or len(self.channels) < MOST_TOPICS:
            self.channels[channel.id] = channel
        else:
            self._say(f"it has more than {MOST_TOPICS:,} topics; the others are left out")

    def _count(self, messages: Iterable[RawMessage]) -> None:
        """Count the messages one by one."""
        for channel_id, time, _ in messages:
            self.start = min(self.start, time) if self.counts else time
            self.end = max(self.end, time)
            self.counts[channel_id] += 1
