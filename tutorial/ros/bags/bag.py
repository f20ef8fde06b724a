"""A bag that is read: which topics it has, and their messages, as far as it goes."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from pathlib import Path, PurePath
from typing import Any, NamedTuple

from rclpy.serialization import deserialize_message

from tutorial.errors import TutorialError, did_you_mean, printable
from tutorial.paths import is_file, is_folder
from tutorial.ros.bags.mcap import McapReader
from tutorial.ros.bags.metadata import read_metadata
from tutorial.ros.bags.sqlite import SqliteReader
from tutorial.ros.bags.storage import MOST_FAULTS, SUFFIXES, Channel, Damaged, FileReader
from tutorial.ros.topics.names import escape_name, message_class

__all__ = ["Bag", "BagTopic"]

READERS: dict[str, Callable[[Path], FileReader]] = {".mcap": McapReader, ".db3": SqliteReader}
MOST_FILES = 10_000
LATEST = 2**63 - 1  # [ns] that a file can say
CDR_HEAD = 4  # bytes that every payload begins with


class BagTopic(NamedTuple):
    """A topic of a bag: its full name, its type such as ``"sensor_msgs/msg/Joy"``, and how many messages it has."""

    name: str
    type: str
    count: int  # type: ignore[assignment]  # no tuple's method here


class Bag:
    """A bag, of ``tank bag record`` or of ``ros2 bag record``; one that was cut off is read as far as it goes.

    Args:
        path: the bag's folder, or one of its files, ``.mcap`` or ``.db3``.

    Attributes:
        path: the same.
        files: its files, in order.
        storage: ``"mcap"`` or ``"sqlite3"``.
        distro: which ROS 2 has written it, such as ``"jazzy"``; empty where it doesn't say.
        channels: what is known of its topics, by name.
        start, end: when the first and the last message was received, since 1970 [ns]; 0 without messages.

    Raises:
        TutorialError: there is no bag, or nothing in it can be read.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.distro = ""
        self._faults: list[str] = []
        self._has_more_faults = False
        self._told_count: int | None = None
        self.files = self._find_files()
        self.storage = next(name for name, suffix in SUFFIXES.items() if suffix == self.files[0].suffix)
        self.channels: dict[str, Channel] = {}
        self._counts: Counter[str] = Counter()
        self.start = self.end = 0
        readable = 0
        for file in self.files:
            with self._opened(file) as reader:
                if reader is not None:
                    readable += 1
                    self._learn(reader)
        self._check_count()
        if not readable:
            raise TutorialError(f"nothing in the bag {_named(self.path)} can be read: {'; '.join(self._faults)}.")

    @property
    def topics(self) -> list[BagTopic]:
        """Its topics, in the order of their names."""
        return [BagTopic(name, self.channels[name].type_name, self._counts[name]) for name in sorted(self.channels)]

    @property
    def duration(self) -> float:
        """From the first message to the last one [s]."""
        return (self.end - self.start) / 1e9

    @property
    def size(self) -> int:
        """Of all its files [bytes]."""
        told = self.path / "metadata.yaml"
        return sum(file.stat().st_size for file in (*self.files, *[told] * is_file(told)))

    @property
    def damage(self) -> str:
        """A sentence that says what is missing or wrong, as far as the bag has been read; empty when nothing is."""
        if not self._faults:
            return ""
        more = "; and others" if self._has_more_faults else ""
        return f"This bag is damaged, and is read as far as it goes: {'; '.join(self._faults)}{more}."

    def channel(self, topic: str) -> Channel:
        """Return what is known of a topic.

        Raises:
            TutorialError: there is no such topic.
        """
        if topic not in self.channels:
            known = [escape_name(name) for name in self.channels]
            raise TutorialError(f"there is no topic '{escape_name(topic)}' in this bag.{did_you_mean(topic, known)}")
        return self.channels[topic]

    def messages(
        self, topics: Collection[str] | None = None, start_offset: float = 0.0
    ) -> Iterator[tuple[str, int, Any]]:
        """Yield the messages in the order in which they were received: (topic, time [ns], message).

        Args:
            topics: only those; None for all.
            start_offset: how much to leave out at the beginning [s].

        Raises:
            TutorialError: there is no such topic, or its messages are of a type that is not known here.
        """
        named = [name for name in self._chosen(topics) if self._counts[name]]
        kinds = {name: message_class(self.channels[name].type_name) for name in named}
        for name, time, payload in self.raw_messages(kinds, start_offset):
            try:
                message = deserialize_message(payload, kinds[name])
            except Exception as error:  # noqa: BLE001 - a real rclpy raises of many kinds
                self._say(f"a message on {escape_name(name)} cannot be decoded: {printable(str(error))[:200]}")
                continue
            yield name, time, message

    def raw_messages(
        self, topics: Collection[str] | None = None, start_offset: float = 0.0
    ) -> Iterator[tuple[str, int, bytes]]:
        """Yield the messages as they travelled, in CDR; the arguments are those of `messages`."""
        chosen = self._chosen(topics)
        since = min(self.start + round(start_offset * 1e9), LATEST)
        for file in self.files:
            with self._opened(file) as reader:
                if reader is None:
                    continue
                names = {number: channel.topic for number, channel in reader.channels.items()}
                wanted = {number for number, name in names.items() if name in chosen}
                for number, time, payload in reader.messages(wanted, since):
                    if len(payload) >= CDR_HEAD:
                        yield names[number], time, payload
                    else:
                        self._say(f"a message on {escape_name(names[number])} is empty")

    def _chosen(self, topics: Collection[str] | None) -> set[str]:
        return set(self.channels) if topics is None else {self.channel(name).topic for name in topics}

    def _learn(self, reader: FileReader) -> None:
        """Add what a file has."""
        for number, channel in reader.channels.items():
            self.channels.setdefault(channel.topic, channel)
            self._counts[channel.topic] += reader.counts[number]
        if any(reader.counts.values()):
            self.start = min(self.start or reader.start, reader.start)
            self.end = max(self.end, reader.end)

    def _check_count(self) -> None:
        """Hold the messages that are there against what the metadata say."""
        found = sum(self._counts.values())
        if self._told_count is not None and self._told_count != found:
            self._say(f"metadata.yaml tells of {self._told_count:,} messages, and {found:,} are there")

    @contextmanager
    def _opened(self, file: Path) -> Iterator[FileReader | None]:
        """Open a file for a while, and keep what turns out to be wrong with it; None where nothing can be read."""
        reader: FileReader | None = None
        try:
            reader = READERS[file.suffix](file)
        except Damaged as damaged:
            self._say(f"{escape_name(file.name)}: {damaged}")
        except OSError as error:
            self._say(f"{escape_name(file.name)} cannot be read: {error.strerror}")
        try:
            yield reader
        finally:
            if reader is not None:
                reader.close()
                for fault in reader.faults:
                    self._say(f"{escape_name(file.name)}: {fault}")

    def _say(self, fault: str) -> None:
        if len(self._faults) >= MOST_FAULTS and fault not in self._faults:
            self._has_more_faults = True
        elif fault not in self._faults:
            self._faults.append(fault)

    def _find_files(self) -> list[Path]:
        """Find the bag's files, and hold them against what its metadata say."""
        if is_file(self.path):
            if self.path.suffix not in READERS:
                raise TutorialError(f"{_named(self.path)} is no bag: its files end in {' or '.join(READERS)}.")
            return [self.path]
        if not is_folder(self.path):
            raise TutorialError(f"there is no bag {_named(self.path)}. A bag is a folder, or an .mcap or .db3 file.")
        files = [path for path in self.path.iterdir() if path.suffix in READERS and is_file(path)]
        files = sorted(files, key=_number)[:MOST_FILES]
        self._check_metadata({file.name for file in files})
        if not files:
            raise TutorialError(f"the folder {_named(self.path)} is no bag: there is no .mcap or .db3 file in it.")
        return [file for file in files if file.suffix == files[0].suffix]

    def _check_metadata(self, names: set[str]) -> None:
        path = self.path / "metadata.yaml"
        if not is_file(path):
            self._say("its metadata.yaml is missing, as of a recording that was killed")
            return
        try:
            told = read_metadata(path)
        except Damaged as damaged:
            self._say(f"metadata.yaml: {damaged}")
            return
        mode = str(told.get("compression_mode") or "none").lower()
        if mode != "none":
            raise TutorialError(
                f"the bag {_named(self.path)} is compressed by {printable(mode[:20])}, which is not read here. On a "
                "real ROS 2, 'ros2 bag convert' makes one of it that is not."
            )
        self.distro = printable(str(told.get("ros_distro") or "")[:60])
        count = told.get("message_count")
        self._told_count = count if isinstance(count, int) else None
        listed = told.get("relative_file_paths")
        wanted = [PurePath(str(name)).name for name in listed[:MOST_FILES]] if isinstance(listed, list) else []
        if missing := [name for name in wanted if name not in names]:
            self._say(f"{len(missing):,} of its files are missing, the first is {escape_name(missing[0])}")


def _number(path: Path) -> tuple[int, str]:
    """Where a file stands in its bag: the 10th behind the 9th."""
    found = re.search(r"_(\d{1,9})$", path.stem)
    return (int(found[1]) if found else 0), path.name


def _named(path: Path) -> str:
    return f"'{printable(str(path))}'"
