"""SQLite files, which ``ros2 bag`` writes with ``-s sqlite3``."""

from __future__ import annotations

import os
import sqlite3
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tutorial.errors import printable
from tutorial.ros.bags.storage import (
    LARGEST_MESSAGE,
    LONGEST_NAME,
    LONGEST_QOS,
    MOST_TOPICS,
    Channel,
    Damaged,
    FileReader,
    RawMessage,
)

__all__ = ["SqliteReader", "SqliteWriter"]

TABLES = """
    CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
    CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
    CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
        serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
    CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
        encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
    CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
        data BLOB NOT NULL);
    CREATE INDEX timestamp_idx ON messages (timestamp ASC);
    INSERT INTO schema(schema_version, ros_distro) VALUES (4, 'jazzy');
"""
"""As ros2 bag has them in Jazzy."""

HAS_TABLES = "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')"
TOPIC_COLUMNS = {
    "name": LONGEST_NAME,
    "type": LONGEST_NAME,
    "serialization_format": LONGEST_NAME,
    "offered_qos_profiles": LONGEST_QOS,
    "type_description_hash": LONGEST_NAME,
}
"""Of the table of topics, and how much of each is read [characters]."""

UNREADABLE = (sqlite3.Error, UnicodeDecodeError)
"""What Python raises of a spoilt file; the second is about SQLite's own words."""


class SqliteWriter:
    """Writes an SQLite file. One thread.

    Args:
        path: the file, which must not be there.

    Raises:
        OSError: it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        path.touch(exist_ok=False)
        with _as_os_error():
            self._database = sqlite3.connect(path, check_same_thread=False)
            self._database.executescript(TABLES)
        self._types: set[str] = set()

    def add_channel(self, channel: Channel) -> None:
        """Make a topic known before its first message."""
        with _as_os_error():
            if channel.type_name not in self._types:
                self._types.add(channel.type_name)
                self._insert(
                    "message_definitions", None, channel.type_name, "ros2msg", channel.definition, channel.type_hash
                )
            words = (channel.topic, channel.type_name, channel.encoding, channel.qos, channel.type_hash)
            self._insert("topics", channel.id, *words)

    def write(self, channel_id: int, received_ns: int, sent_ns: int, payload: bytes) -> None:  # noqa: ARG002
        """Write a message, for which the file has one time only: when it was received."""
        with _as_os_error():
            self._insert("messages", None, channel_id, received_ns, payload)

    def flush(self) -> None:
        """Commit what is written."""
        with _as_os_error():
            self._database.commit()

    def close(self, metadata: str) -> None:
        """Complete the file."""
        with _as_os_error():
            try:
                self._insert("metadata", None, 9, metadata)
                self._database.commit()
            finally:
                self._database.close()

    def _insert(self, table: str, *values: Any) -> None:
        self._database.execute(f"INSERT INTO {table} VALUES ({', '.join('?' * len(values))})", values)


class SqliteReader(FileReader):
    """Reads an SQLite file, as far as it goes. See `tutorial.ros.bags.storage.FileReader`."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._check_size()
        self._database = self._opened()
        try:
            self._learn_topics()
            self._count_messages()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the file. Idempotent."""
        self._database.close()

    def messages(self, wanted: Collection[int], since: int) -> Iterator[RawMessage]:
        """Yield the messages of these channels in the order of time, from a time on [ns]; of a damaged file, in that
        in which they were written."""
        ids = ", ".join(str(int(number)) for number in wanted)
        order = "id" if self.faults else "timestamp, id"
        query = f"SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN ({ids}) AND timestamp >= ? "
        try:
            for channel_id, time, payload in self._database.execute(f"{query} ORDER BY {order}", (since,)):
                if isinstance(time, int) and isinstance(payload, bytes) and channel_id in self.channels:
                    yield channel_id, time, payload
                else:
                    self._say("a row in it is no message")
        except UNREADABLE as error:
            self._say(f"SQLite says: {printable(str(error))}")

    def _check_size(self) -> None:
        """Say when the last page is incomplete: SQLite reads zeros for what is missing of it, without a word."""
        with self.path.open("rb") as file:
            head = file.read(18)
            size = file.seek(0, os.SEEK_END)
        page = int.from_bytes(head[16:], "big") or 1
        page = 65536 if page == 1 else page  # which two bytes cannot say
        if size % page:
            self._say("its last page is incomplete, so messages there may be wrong")

    def _opened(self) -> sqlite3.Connection:
        """Open the file without a change to it. What a killed recording has left half done may stand beside it."""
        address = self.path.absolute().as_uri()
        for how in ("mode=ro", "immutable=1"):
            database = sqlite3.connect(f"{address}?{how}", uri=True, check_same_thread=False)
            database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_MESSAGE)
            database.text_factory = lambda data: data.decode("utf-8", "backslashreplace")
            try:
                database.execute("PRAGMA trusted_schema = OFF")
                tables = database.execute(HAS_TABLES).fetchone()[0]
            except UNREADABLE as error:
                database.close()
                refusal = f"SQLite says: {printable(str(error))}"
                continue
            if how != "mode=ro":
                self._say("its last transaction is incomplete")
            if tables == 2:
                return database
            database.close()
            refusal = "it has no tables 'topics' and 'messages'"
        raise Damaged(refusal)

    def _learn_topics(self) -> None:
        """Read the topics; older files have no hashes of types."""
        try:
            there = {row[1] for row in self._database.execute("PRAGMA table_info(topics)").fetchmany(100)}
            words = [
                f"substr({word}, 1, {longest})" if word in there else "''" for word, longest in TOPIC_COLUMNS.items()
            ]
            query = f"SELECT id, {', '.join(words)} FROM topics ORDER BY id LIMIT {MOST_TOPICS + 1}"
            for number, *texts in self._database.execute(query):
                topic, type_name, encoding, qos, type_hash = map(str, texts)
                self._learn(Channel(int(number), topic, type_name, encoding, qos, type_hash=type_hash))
        except (*UNREADABLE, ValueError, TypeError) as error:
            raise Damaged(f"its topics cannot be read: {printable(str(error))}") from error

    def _count_messages(self) -> None:
        """Count the messages of each topic; where the file is damaged, those that can be reached."""
        query = "SELECT topic_id, count(*), min(timestamp), max(timestamp) FROM messages GROUP BY topic_id"
        try:
            rows = self._database.execute(query).fetchmany(MOST_TOPICS)
            known = [row for row in rows if row[0] in self.channels and all(isinstance(time, int) for time in row[2:])]
            if len(known) < len(rows):
                self._say("a row in it is no message")
            self.counts = Counter({row[0]: row[1] for row in known})
            self.start = min((row[2] for row in known), default=0)
            self.end = max((row[3] for row in known), default=0)
        except UNREADABLE as error:
            self._say(f"SQLite says: {printable(str(error))}")
            self._count(self.messages(self.channels, 0))


@contextmanager
def _as_os_error() -> Iterator[None]:
    """Turn SQLite's errors into what they are to whoever writes: errors of the disk."""
    try:
        yield
    except sqlite3.Error as error:
        raise OSError(0, str(error)) from error
