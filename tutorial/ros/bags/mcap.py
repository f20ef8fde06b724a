"""MCAP files, as ``ros2 bag`` writes them by default (https://mcap.dev/spec).

A file is a sequence of records. Messages are gathered in chunks; behind the last one an index repeats what is in the
file. How records are laid out is known to the package mcap. It has readers, too, and so has rosbags; but they want a
file that is whole and means well, and ours reads what a program that was killed has left, or a spoilt disk.
"""

from __future__ import annotations

import os
import zlib
from collections import Counter
from collections.abc import Collection, Iterable, Iterator
from contextlib import suppress
from heapq import heappop, heappush
from io import BytesIO
from pathlib import Path
from struct import error
from typing import IO, Any

from backports import zstd
from lz4.frame import LZ4FrameDecompressor
from mcap import records
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile
from mcap.opcode import Opcode
from mcap.reader import FOOTER_SIZE
from mcap.writer import MCAP0_MAGIC, CompressionType, Writer

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

__all__ = ["McapReader", "McapWriter"]

CHUNK_SIZE = 768 * 1024  # [bytes], as ros2 bag's
LARGEST_CHUNK = LARGEST_MESSAGE + 64  # with what stands before the messages [bytes]
LARGEST_TEXT = 2**20  # of a definition, or of other words of a record [bytes]
LARGEST_SUMMARY = 64 * 2**20  # [bytes]
REORDERED = 64 * 2**20  # of messages that wait for earlier ones, at most [bytes]

KINDS: dict[int, Any] = {
    Opcode.HEADER: records.Header,
    Opcode.FOOTER: records.Footer,
    Opcode.SCHEMA: records.Schema,
    Opcode.CHANNEL: records.Channel,
    Opcode.MESSAGE: records.Message,
    Opcode.CHUNK: records.Chunk,
    Opcode.STATISTICS: records.Statistics,
}
"""Of records that are read; the others are passed over."""

DECOMPRESSORS: dict[str, Any] = {"zstd": zstd.ZstdDecompressor, "lz4": LZ4FrameDecompressor}
"""Those that stop at a given length: the package's own do not."""

UNREADABLE = (EndOfFile, error, UnicodeDecodeError, OverflowError)
"""What the package raises of a spoilt record."""


class McapWriter:
    """Writes an MCAP file. One thread.

    Args:
        path: the file, which must not be there.

    Raises:
        OSError: it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("xb")
        self._writer = Writer(self._file, CHUNK_SIZE, CompressionType.NONE)
        self._schemas: dict[str, int] = {}  # ids by type
        self._ids: dict[int, int] = {}  # of channels, as the file numbers them
        self._counts: Counter[int] = Counter()
        self._writer.start("ros2", "tank-tutorial")
        self._writer.flush()

    def add_channel(self, channel: Channel) -> None:
        """Make a topic known before its first message."""
        kind = channel.type_name
        if kind not in self._schemas:
            self._schemas[kind] = self._writer.register_schema(kind, "ros2msg", channel.definition.encode())
        words = {"offered_qos_profiles": channel.qos, "topic_type_hash": channel.type_hash}
        id_here = self._writer.register_channel(channel.topic, channel.encoding, self._schemas[kind], words)
        self._ids[channel.id] = id_here

    def write(self, channel_id: int, received_ns: int, sent_ns: int, payload: bytes) -> None:
        """Write a message; it is in the file after `flush`."""
        sequence = self._counts[channel_id] & 0xFFFFFFFF
        self._writer.add_message(self._ids[channel_id], received_ns, payload, sent_ns, sequence)
        self._counts[channel_id] += 1

    def flush(self) -> None:
        """Write the messages so far as a chunk, with its index behind it."""
        self._writer.flush()

    def close(self, metadata: str) -> None:
        """Write what is left, and the summary."""
        try:
            self.flush()
            self._writer.add_metadata("rosbag2", {"serialized_metadata": metadata})
            self._writer.finish()
        finally:
            self._file.close()


class McapReader(FileReader):
    """Reads an MCAP file of ROS 2, as far as it goes. See `tutorial.ros.bags.storage.FileReader`."""

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self._types: dict[int, str] = {}  # names by the schema's id
        self._data_end = path.stat().st_size
        self._file = path.open("rb")
        try:
            self._check_begin()
            if not self._read_summary():
                self._count(message for _, messages in self._chunks(0) for message in messages)
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the file. Idempotent."""
        self._file.close()

    def messages(self, wanted: Collection[int], since: int) -> Iterator[RawMessage]:
        """Yield the messages of these channels in the order of time, from a time on [ns].

        Messages that were written late are put where they belong, if that is no further than a chunk away.
        """
        waiting: list[tuple[int, int, int, bytes]] = []  # a heap
        held = number = 0
        for earliest, messages in self._chunks(since):
            while waiting and (waiting[0][0] < earliest or held > REORDERED):
                time, _, channel_id, payload = heappop(waiting)
                held -= len(payload)
                yield channel_id, time, payload
            for channel_id, time, payload in messages:
                if time >= since and channel_id in wanted:
                    number, held = number + 1, held + len(payload)
                    heappush(waiting, (time, number, channel_id, payload))
        for time, _, channel_id, payload in sorted(waiting):
            yield channel_id, time, payload

    def _check_begin(self) -> None:
        """Refuse what is no such file; one that is cut off in its first record may be."""
        header, begin = None, self._file.read(len(MCAP0_MAGIC))
        if begin != MCAP0_MAGIC:
            raise Damaged(f"it begins with {begin.hex(' ')!r}, not as an MCAP file does" if begin else "it is empty")
        with suppress(Damaged):
            header = next(self._records(self._file, len(begin), self._data_end), None)
        if isinstance(header, records.Header) and header.profile != "ros2":
            raise Damaged(f"it is of '{printable(header.profile[:60])}', not of 'ros2'")

    def _read_summary(self) -> bool:
        """Take topics and counts from behind the data; False where that is not possible."""
        self._file.seek(-len(MCAP0_MAGIC), os.SEEK_END)
        if self._file.read() != MCAP0_MAGIC:
            self._say("its end is missing, as of a recording that was killed or filled the disk")
            return False
        last = max(self._data_end - len(MCAP0_MAGIC) - FOOTER_SIZE, 0)
        told = None
        try:
            footer = next(self._records(self._file, last, self._data_end), None)
            begin = footer.summary_start if isinstance(footer, records.Footer) else 0
            there = len(MCAP0_MAGIC) <= begin < last and last - begin <= LARGEST_SUMMARY  # it may be left out
            self._data_end = begin if there else last
            for record in self._records(self._file, self._data_end, last):
                if isinstance(record, records.Statistics):
                    told = record
                else:
                    self._take(record)
        except Damaged as damaged:
            self._say(str(damaged))
            return False
        return told is not None and self._believes(told)

    def _believes(self, told: records.Statistics) -> bool:
        """Take counts and times, if they can be."""
        counts = Counter({i: count for i, count in told.channel_message_counts.items() if i in self.channels})
        start, end = told.message_start_time, told.message_end_time
        if told.message_count != sum(counts.values()) or not start <= end < 2**63:
            return False
        self.counts, self.start, self.end = counts, start, end
        return True

    def _chunks(self, since: int) -> Iterator[tuple[int, Iterable[RawMessage]]]:
        """Yield when each chunk begins [ns], and its messages; those that end before a time are left out.

        A message that stands outside of chunks is one of its own.
        """
        try:
            for record in self._records(self._file, len(MCAP0_MAGIC), self._data_end):
                if not isinstance(record, records.Chunk):
                    yield from ((message[1], [message]) for message in self._messages_in([record]))
                elif record.message_end_time >= since:
                    yield record.message_start_time, self._messages_in(self._unpacked(record))
        except Damaged as damaged:
            self._say(str(damaged))

    def _unpacked(self, chunk: records.Chunk) -> Iterator[records.McapRecord]:
        """Yield the records of a chunk, up to where it is cut off; none where it cannot be unpacked."""
        size, how = chunk.uncompressed_size, chunk.compression
        if size > LARGEST_MESSAGE:
            self._say(f"a chunk in it has {size:,} bytes, and {LARGEST_MESSAGE:,} are the most that is read")
        elif how and how not in DECOMPRESSORS:
            self._say(f"a chunk in it is compressed by '{printable(how[:20])}', and not by zstd or lz4")
        else:
            try:
                data = DECOMPRESSORS[how]().decompress(chunk.data, max_length=size) if how else chunk.data[:size]
                if len(data) == size and chunk.uncompressed_crc not in (0, zlib.crc32(data)):
                    self._say("a chunk in it has another checksum than it had when it was written")
                yield from self._records(BytesIO(data), 0, size)
            except Damaged:
                self._say("a chunk in it is incomplete")
            except (zstd.ZstdError, RuntimeError, EOFError, ValueError) as wrong:
                self._say(f"a chunk in it cannot be unpacked: {printable(str(wrong))}")

    def _messages_in(self, some: Iterable[records.McapRecord]) -> Iterator[RawMessage]:
        """Yield the messages among some records, and learn their topics."""
        for record in some:
            if not isinstance(record, records.Message):
                self._take(record)
            elif record.channel_id in self.channels and record.log_time < 2**63:
                yield record.channel_id, record.log_time, record.data
            else:
                self._say("a message in it belongs to no topic")

    def _take(self, record: records.McapRecord) -> None:
        """Learn a topic, or what its messages are."""
        if isinstance(record, records.Schema) and len(self._types) < MOST_TOPICS:
            self._types[record.id] = record.name[:LONGEST_NAME]
        elif isinstance(record, records.Channel):
            qos = record.metadata.get("offered_qos_profiles", "")[:LONGEST_QOS]
            type_hash = record.metadata.get("topic_type_hash", "")[:LONGEST_NAME]
            topic, encoding = record.topic[:LONGEST_NAME], record.message_encoding[:LONGEST_NAME]
            type_name = self._types.get(record.schema_id, "")
            self._learn(Channel(record.id, topic, type_name, encoding, qos, type_hash=type_hash))

    def _records(self, file: IO[bytes], begin: int, end: int) -> Iterator[records.McapRecord]:
        """Yield each record that is of interest and can be read; of a chunk that is cut off, what is there.

        Raises:
            Damaged: it is cut off.
        """
        head = ReadDataStream(file)
        while begin < end:
            file.seek(begin)
            try:
                opcode, size = head.read1(), head.read8()
            except UNREADABLE:
                raise Damaged("it ends in the middle of a record") from None
            begin = file.tell() + size
            kind = KINDS.get(opcode)
            largest = LARGEST_CHUNK if kind in (records.Message, records.Chunk) else LARGEST_TEXT
            if kind and size > largest:
                self._say(f"a record in it has {size:,} bytes, and {largest:,} are the most that is read")
            elif kind:
                body = file.read(size)
                try:
                    if kind is records.Message and len(body) == size:
                        yield kind.read(ReadDataStream(BytesIO(body)), size)
                    elif kind is records.Chunk or len(body) == size:
                        yield kind.read(_Words(BytesIO(body)))
                except UNREADABLE:
                    what = "is too short" if kind is records.Message else "ends in the middle of a word"
                    self._say(f"a record in it {what}")
            if begin > end:
                raise Damaged("it ends in the middle of a record")


class _Words(ReadDataStream):
    """The content of a record: its texts are whole, whatever bytes they are made of."""

    def read_prefixed_string(self) -> str:
        length = self.read4()
        data = self.read(length)
        if len(data) < length:
            raise EndOfFile
        return data.decode("utf-8", "backslashreplace")
