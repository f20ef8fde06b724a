"""Read a bag's topics and messages, or as many of them as possible if the bag is damaged."""

import logging
import re
from collections import Counter
from collections.abc import Collection, Iterator
from itertools import chain
from math import inf
from operator import itemgetter
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
from backports import zstd

from tutorial.errors import TutorialError, did_you_mean, printable
from tutorial.ros.bags.file_kind import foreign, suffix_of
from tutorial.ros.bags.mcap import McapReader
from tutorial.ros.bags.sqlite import SqliteReader
from tutorial.ros.bags.storage import LARGEST_MESSAGE, Channel, CorruptBagError, RawMessage, Span, read_yaml
from tutorial.ros.topics.names import escape_name, message_class
from tutorial.system.paths import is_file, is_folder

READERS: dict[str, type[McapReader | SqliteReader]] = {".mcap": McapReader, ".db3": SqliteReader}
MOST_FAULTS = 5  # maximum number of faults to report
CDR_HEAD = 4  # bytes at the start of every payload
ZSTD_HEAD = b"\x28\xb5\x2f\xfd"  # start of a payload that ros2 bag has compressed

_log = logging.getLogger(__name__)


class BagTopic(NamedTuple):
    """A topic of a bag: its full name, its type such as ``"sensor_msgs/msg/Joy"``, and its number of messages."""

    name: str
    type: str
    count: int  # type: ignore[assignment]  # hides tuple.count


class _Information(msgspec.Struct):
    """The fields read from a bag's ``metadata.yaml``; its other fields repeat information from the bag's files."""

    message_count: int | None = None
    compression_mode: str = ""
    ros_distro: str = ""


class _Metadata(msgspec.Struct):
    rosbag2_bagfile_information: _Information


class Bag:
    """A bag recorded by ``tank bag record`` or ``ros2 bag record``; if it is damaged, as much as possible is read.

    Args:
        path: the bag's folder or one of its files, MCAP or SQLite.

    Attributes:
        path: the given path.
        files: its files, in order.
        storage: ``"mcap"`` or ``"sqlite3"``.
        distro: the ROS 2 distribution that wrote it, such as ``"jazzy"``; empty if unknown.
        channels: descriptions of its topics, by name.
        start, end: when the first and last messages were received [ns since 1970]; 0 if there are no messages.

    Raises:
        TutorialError: there is no bag, or nothing in it can be read.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._faults: dict[str, None] = {}  # in order
        self.files, told = self._find()
        self.storage = "mcap" if suffix_of(self.files[0]) == ".mcap" else "sqlite3"
        self.distro = printable(told.ros_distro[:60])
        self.channels: dict[str, Channel] = {}
        self._counts: Counter[str] = Counter()
        self._readers = [reader for file in self.files if (reader := self._opened(file)) is not None]
        if not self._readers:
            raise TutorialError(f"nothing in the bag {_named(self.path)} can be read: {'; '.join(self._faults)}.")
        span = Span()
        for topic, time, _ in self._in_order():
            self._counts[topic] += 1
            span.add(time)
        for reader in self._readers:
            self.channels = {channel.topic: channel for channel in reader.channels.values()} | self.channels
        self.start, self.end = span.start, span.end
        if told.message_count not in (None, span.count):
            self._say(f"metadata.yaml lists {told.message_count:,} messages, but the bag has {span.count:,}")

    @property
    def topics(self) -> list[BagTopic]:
        """The bag's topics, sorted by name."""
        return [BagTopic(name, self.channels[name].type_name, self._counts[name]) for name in sorted(self.channels)]

    @property
    def duration(self) -> float:
        """Time from the first message to the last one [s]."""
        return (self.end - self.start) / 1e9

    @property
    def size(self) -> int:
        """Total size of the bag's files [bytes]."""
        told = self.path / "metadata.yaml"
        return sum(file.stat().st_size for file in (*self.files, *[told] * is_file(told)))

    @property
    def damage(self) -> str:
        """A sentence about the missing or damaged data found so far; empty if no damage was found."""
        if not self._faults:
            return ""
        first, more = list(self._faults)[:MOST_FAULTS], "; and others" if len(self._faults) > MOST_FAULTS else ""
        return f"This bag is damaged, and is read as far as possible: {'; '.join(first)}{more}."

    def channel(self, topic: str) -> Channel:
        """Return the description of a topic.

        Args:
            topic: its name. The leading slash may be missing here or in the bag.

        Raises:
            TutorialError: there is no such topic.
        """
        for name in (topic, f"/{topic}", topic.removeprefix("/")):
            if name in self.channels:
                return self.channels[name]
        known = [escape_name(name) for name in self.channels]
        raise TutorialError(f"there is no topic '{escape_name(topic)}' in this bag.{did_you_mean(topic, known)}")

    def messages(self, topics: Collection[str] | None = None) -> Iterator[tuple[str, int, Any]]:
        """Yield the messages in order of receipt: (topic, time [ns], message).

        Args:
            topics: the topics to read; None for all topics whose types are known here. A warning is logged for
                each topic that is skipped.

        Raises:
            TutorialError: there is no such topic, its type is not known here, or its messages are not in CDR.
        """
        from rclpy.serialization import deserialize_message  # noqa: PLC0415 - `tank bag info` works without rclpy

        kinds = {}
        for channel in map(self.channel, self.channels if topics is None else topics):
            try:
                if self._counts[channel.topic]:
                    kinds[channel.topic] = _class_of(channel)
            except TutorialError as error:
                if topics is not None:
                    raise
                _log.warning("topic %s is skipped: %s", escape_name(channel.topic), error)
        for name, time, payload in self.raw_messages(kinds):
            try:
                message = deserialize_message(payload, kinds[name])
            except Exception as error:  # noqa: BLE001 - the real rclpy raises many kinds of exceptions
                self._say(f"a message on {escape_name(name)} cannot be decoded: {printable(str(error))[:200]}")
                continue
            yield name, time, message

    def raw_messages(self, topics: Collection[str] | None = None, start_offset: float = 0.0) -> Iterator[RawMessage]:
        """Yield the messages as CDR, without decoding them.

        Args:
            topics: the topics to read; None for all.
            start_offset: time to skip at the beginning [s].

        Raises:
            TutorialError: there is no such topic.
        """
        wanted = {self.channel(name).topic for name in (self.channels if topics is None else topics)}
        since = self.start + round(start_offset * 1e9)
        for name, time, stored in self._in_order(since):
            if name in wanted and time >= since:
                payload = self._unpacked(name, stored) if stored.startswith(ZSTD_HEAD) else stored
                if payload is None:
                    continue
                if len(payload) < CDR_HEAD:
                    self._say(f"a message on {escape_name(name)} is empty")
                else:
                    yield name, time, payload

    def _unpacked(self, topic: str, packed: bytes) -> bytes | None:
        """Decompress a message; return None if it is damaged or too large."""
        unpacker = zstd.ZstdDecompressor()
        try:
            payload = unpacker.decompress(packed, max_length=LARGEST_MESSAGE)
            if unpacker.eof:
                return payload
            wrong = "it is incomplete, or too large"
        except zstd.ZstdError as error:
            wrong = printable(str(error))
        self._say(f"a message on {escape_name(topic)} cannot be unpacked: {wrong}")
        return None

    def _in_order(self, since: float = -inf) -> Iterator[RawMessage]:
        """Yield the messages sorted by time. A message written up to one batch late is moved to its correct place."""
        waiting: list[RawMessage] = []
        for batch in chain.from_iterable(reader.batches(since) for reader in self._readers):
            found = list(batch)
            known = sorted(waiting + found, key=itemgetter(1))
            yield from known[: len(waiting)]
            waiting = known[len(waiting) :]
        yield from waiting

    def _opened(self, file: Path) -> McapReader | SqliteReader | None:
        """Open a file; return None if nothing in it can be read."""
        name = escape_name(file.name)
        try:
            if what := foreign(file):
                raise CorruptBagError(what)
            return READERS[suffix_of(file)](file, lambda fault: self._say(f"{name}: {fault}"))
        except CorruptBagError as error:
            self._say(f"{name}: {error}")
        except OSError as error:
            self._say(f"{name} cannot be read: {error.strerror}")
        return None

    def _say(self, fault: str) -> None:
        self._faults.setdefault(fault)

    def _find(self) -> tuple[list[Path], _Information]:
        """Return the bag's files and its metadata."""
        if is_file(self.path):
            if what := foreign(self.path):
                raise TutorialError(f"{_named(self.path)} is not a bag: {what}.")
            return [self.path], _Information()
        if not is_folder(self.path):
            raise TutorialError(f"there is no bag {_named(self.path)}. A bag is a folder, or an .mcap or .db3 file.")
        told = self._read_metadata()
        every = sorted(filter(is_file, self.path.iterdir()), key=_number)
        files = [path for path in every if path.suffix in READERS]
        if not files:
            others = [path for path in every if path.name != "metadata.yaml"]
            seen = next((f" {_named(path)}: {what}." for path in others if (what := foreign(path))), "")
            if told.compression_mode.lower() == "file":
                raise TutorialError(f"the files of the bag {_named(self.path)} are compressed.{seen}")
            raise TutorialError(f"the folder {_named(self.path)} is not a bag: it has no .mcap or .db3 file.{seen}")
        return [file for file in files if file.suffix == files[0].suffix], told

    def _read_metadata(self) -> _Information:
        path = self.path / "metadata.yaml"
        if not is_file(path):
            self._say("its metadata.yaml is missing, as happens if the recorder is killed")
            return _Information()
        try:
            return msgspec.convert(read_yaml(path.read_bytes()), _Metadata).rosbag2_bagfile_information
        except (OSError, msgspec.ValidationError) as error:
            self._say(f"metadata.yaml: {printable(str(error))}")
        except Exception:  # noqa: BLE001 - invalid text can raise anything
            self._say("metadata.yaml: it is not valid YAML")
        return _Information()


def _class_of(channel: Channel) -> Any:
    """Return the class of a topic's messages.

    Raises:
        TutorialError: the type is not known here, or the messages are not in CDR.
    """
    found = message_class(channel.type_name)
    if channel.encoding != "cdr":
        encoding, topic = escape_name(channel.encoding), escape_name(channel.topic)
        raise TutorialError(f"the messages on {topic} are '{encoding}', not 'cdr'")
    return found


def _number(path: Path) -> tuple[int, str]:
    """Return a key that sorts a bag's files by number: 10 after 9."""
    found = re.search(r"_(\d{1,9})$", path.stem)
    return (int(found[1]) if found else 0), path.name


def _named(path: Path) -> str:
    return f"'{printable(str(path))}'"
