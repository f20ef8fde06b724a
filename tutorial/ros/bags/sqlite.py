"""SQLite files, which ``ros2 bag`` writes with ``-s sqlite3``."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Collection, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from tutorial.errors import printable
from tutorial.ros.bags.storage import Channel, Damaged, FileReader, RawMessage, Span

__all__ = ["SqliteReader", "SqliteWriter"]

TOPICS = "SELECT id, name, type, serialization_format, offered_qos_profiles FROM topics"
TABLES = Sqlite3Writer.SQLITE_SCHEMA.replace("'rosbags'", "'jazzy'")
COUNT = """
    SELECT topic_id, typeof(timestamp) = 'integer' AND typeof(data) = 'blob', count(*), min(timestamp), max(timestamp)
    FROM messages GROUP BY 1, 2
"""
UNREADABLE = (sqlite3.Error, UnicodeDecodeError)
"""What Python raises of a spoilt file; the second is about SQLite's own words."""


class SqliteWriter:
    """Writes an SQLite file. One thread at a time.

    Args:
        path: the file, which must not be there.

    Raises:
        OSError: it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        path.touch(exist_ok=False)
        self._ids: dict[str, int] = {}  # by topic
        self._types: set[str] = set()
        self._database = sqlite3.connect(path, check_same_thread=False, isolation_level=None)
        for statement in TABLES.split(";"):
            self._run(statement)
        self._run("BEGIN")

    def add_channel(self, channel: Channel) -> None:
        """Make a topic known before its first message."""
        kind, type_hash = channel.type_name, channel.type_hash
        if kind not in self._types:
            self._types.add(kind)
            self._insert("message_definitions", kind, "ros2msg", channel.definition, type_hash)
        self._ids[channel.topic] = len(self._ids) + 1
        self._insert("topics", channel.topic, kind, channel.encoding, channel.qos, type_hash)

    def write(self, topic: str, received_ns: int, sent_ns: int, payload: bytes) -> None:  # noqa: ARG002
        """Write a message, for which the file has one time only: when it was received."""
        self._insert("messages", self._ids[topic], received_ns, payload)

    def flush(self) -> None:
        """Commit what is written."""
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
        except sqlite3.Error as error:  # to a program that writes, it is an error of the disk
            raise OSError(0, str(error)) from error


class SqliteReader(FileReader):
    """Reads an SQLite file, as far as it goes. See `tutorial.ros.bags.storage.FileReader`."""

    def __init__(self, path: Path, say: Callable[[str], object]) -> None:
        super().__init__(path, say)
        self._how = "mode=ro"
        self._order = "timestamp, id"
        try:
            self._learn_topics()
            if path.stat().st_size % next(self._rows("PRAGMA page_size"))[0]:
                self._damaged("its last page is incomplete, so messages there may be wrong")  # SQLite reads zeros there
        except UNREADABLE as error:
            raise Damaged(f"SQLite says: {printable(str(error))}") from error
        self._count_messages()

    def messages(self, topics: Collection[str], since: int) -> Iterator[RawMessage]:
        """Yield the messages of these topics in the order of time, from a time on [ns]; of a damaged file, in that in
        which they were written."""
        ids = [number for number, channel in self.channels.items() if channel.topic in topics]
        places = ", ".join("?" * len(ids))
        query = f"SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({places}) AND timestamp >= ?"
        try:
            for number, time, payload in self._rows(f"{query} ORDER BY {self._order}", *ids, since):
                if isinstance(time, int) and isinstance(payload, bytes):
                    yield self.channels[number].topic, time, payload
                else:
                    self._say("a row in it is no message")
        except UNREADABLE as error:
            self._say(f"SQLite says: {printable(str(error))}")

    def _rows(self, query: str, *values: Any) -> Iterator[tuple[Any, ...]]:
        """Yield what a query finds. The file is not changed."""
        address = f"{self._path.absolute().as_uri()}?{self._how}"
        with closing(sqlite3.connect(address, uri=True, check_same_thread=False)) as database:
            database.text_factory = lambda data: data.decode("utf-8", "backslashreplace")
            yield from database.execute(query, values)

    def _damaged(self, fault: str) -> None:
        """Say what is wrong with the file, whose index is not to be relied on."""
        self._say(fault)
        self._order = "id"

    def _learn_topics(self) -> None:
        """Read the topics. What a killed recording has left half done may stand beside the file."""
        try:
            rows = list(self._rows(TOPICS))
        except UNREADABLE:
            self._how = "immutable=1"
            rows = list(self._rows(TOPICS))
            self._damaged("its last transaction is incomplete")
        self.channels = {number: Channel(*map(str, words)) for number, *words in rows}

    def _count_messages(self) -> None:
        """Count the messages of each topic; where the file is damaged, those that can be reached."""
        try:
            for number, is_message, count, start, end in self._rows(COUNT):
                if is_message and number in self.channels:
                    self.span.add(count, start, end)
                    self.counts[self.channels[number].topic] += count
                else:
                    self._damaged("a row in it is no message")
        except UNREADABLE as error:
            self._damaged(f"SQLite says: {printable(str(error))}")
            self.counts.clear()
            self.span = Span()
            self._count(self.messages([channel.topic for channel in self.channels.values()], 0))
