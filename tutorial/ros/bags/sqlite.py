"""Read and write SQLite files, which ``ros2 bag`` writes with ``-s sqlite3``."""

import sqlite3
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from itertools import islice
from pathlib import Path
from typing import Any

from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from tutorial.errors import printable
from tutorial.ros.bags.storage import LARGEST_MESSAGE, Channel, CorruptBagError, RawMessage

COLUMNS = {"id": "id", "name": "name", "type": "type", "serialization_format": "'cdr'", "offered_qos_profiles": "''"}
"""The columns that are read for each topic, with a default for columns that older versions of ros2 bag don't write."""
TABLES = Sqlite3Writer.SQLITE_SCHEMA.replace("'rosbags'", "'jazzy'")
MESSAGES = "SELECT topic_id, timestamp, data FROM messages WHERE +timestamp >= ? ORDER BY id"  # + disables the index
UNFINISHED = {
    "-journal": "its last transaction is incomplete",
    "-wal": "its -wal file cannot be read here. Copy both files to a folder that you can write to",
}
"""Suffixes of the files that SQLite keeps next to a database, and what to report if it cannot use them."""
BATCH = 100  # messages per batch; a message may be this many places away from its correct position
UNREADABLE = (sqlite3.Error, UnicodeDecodeError)  # raised for a damaged file, or while decoding SQLite's error text


class SqliteWriter:
    """Writes an SQLite file. Use it from only one thread at a time.

    Args:
        path: the file, which must not exist.

    Raises:
        OSError: the file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        path.touch(exist_ok=False)
        self._ids: dict[str, int] = {}  # ids by topic
        self._types: set[str] = set()
        self._database = sqlite3.connect(path, check_same_thread=False, isolation_level=None)
        for statement in TABLES.split(";"):
            self._run(statement)
        self._run("BEGIN")

    def add_channel(self, channel: Channel) -> None:
        """Register a topic before its first message."""
        kind, type_hash = channel.type_name, channel.type_hash
        if kind not in self._types:
            self._types.add(kind)
            self._insert("message_definitions", kind, "ros2msg", channel.definition, type_hash)
        self._ids[channel.topic] = len(self._ids) + 1
        self._insert("topics", channel.topic, kind, channel.encoding, channel.qos, type_hash)

    def write(self, topic: str, received_ns: int, sent_ns: int, payload: bytes) -> None:  # noqa: ARG002
        """Write a message with its time of receipt, the only time that the file stores."""
        self._insert("messages", self._ids[topic], received_ns, payload)

    def flush(self) -> None:
        """Commit the rows written so far."""
        self._run("COMMIT")
        self._run("BEGIN")

    def close(self, metadata: str) -> None:
        """Write the bag's metadata, and complete the file."""
        with closing(self._database):
            self._insert("metadata", 9, metadata)
            self._run("COMMIT")

    def _insert(self, table: str, *values: Any) -> None:
        """Add a row; SQLite numbers it."""
        self._run(f"INSERT INTO {table} VALUES (NULL{', ?' * len(values)})", *values)

    def _run(self, statement: str, *values: Any) -> None:
        try:
            self._database.execute(statement, values)
        except sqlite3.Error as error:  # callers handle OSError, as they do for a full disk
            raise OSError(0, str(error)) from error


class SqliteReader:
    """Reads an SQLite file, or as much of it as possible if it is damaged. See `tutorial.ros.bags.mcap.McapReader`.

    It reads messages in the order they were written, because the time index may be damaged.
    """

    def __init__(self, path: Path, say: Callable[[str], object]) -> None:
        self._path = path
        self._say = say
        self._how = "mode=ro"
        try:
            try:
                rows = self._topics()
            except UNREADABLE:  # the folder is read-only, or a killed recording left files next to this one
                self._how = "immutable=1"
                for suffix, missing in UNFINISHED.items():
                    if _has_content(Path(f"{path}{suffix}")):
                        say(missing)
                rows = self._topics()
            if path.stat().st_size % next(self._rows("PRAGMA page_size"))[0]:  # SQLite reads the missing bytes as zeros
                say("its last page is incomplete, so messages on it may be wrong")
        except UNREADABLE as error:
            raise CorruptBagError(f"SQLite reports: {printable(str(error))}") from error
        self.channels = {number: Channel(*map(str, words)) for number, *words in rows}

    def _topics(self) -> list[tuple[Any, ...]]:
        there = {name for _, name, *_ in self._rows("PRAGMA table_info(topics)")}
        columns = (name if name in there else default for name, default in COLUMNS.items())
        return list(self._rows(f"SELECT {', '.join(columns)} FROM topics"))

    def batches(self, since: float) -> Iterator[Iterable[RawMessage]]:
        """Yield the messages received at or after a time [ns], in batches."""
        messages = self._messages(since)
        while batch := list(islice(messages, BATCH)):
            yield batch

    def _messages(self, since: float) -> Iterator[RawMessage]:
        try:
            for number, time, payload in self._rows(MESSAGES, since):
                if number in self.channels and isinstance(time, int) and isinstance(payload, bytes):
                    yield self.channels[number].topic, time, payload
                else:
                    self._say("a row in it is not a message")
        except UNREADABLE as error:
            self._say(f"SQLite reports: {printable(str(error))}")

    def _rows(self, query: str, *values: Any) -> Iterator[tuple[Any, ...]]:
        """Yield the rows that a query finds, without changing the file."""
        address = f"{self._path.absolute().as_uri()}?{self._how}"
        with closing(sqlite3.connect(address, uri=True, check_same_thread=False)) as database:
            database.text_factory = lambda data: data.decode("utf-8", "backslashreplace")
            database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_MESSAGE)
            # the last argument names a view, if any: deny views, because a query on a view may never end
            database.set_authorizer(lambda *names: sqlite3.SQLITE_DENY if names[-1] else sqlite3.SQLITE_OK)
            yield from database.execute(query, values)


def _has_content(path: Path) -> bool:
    return path.is_file() and path.stat().st_size > 0
