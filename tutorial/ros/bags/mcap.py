"""MCAP files, as ``ros2 bag`` writes them by default (https://mcap.dev/spec).

A file is a sequence of records: a byte that says which kind it is, its length, its content. Messages are gathered in
chunks; behind the last one an index repeats what is in the file. rosbags has a writer and a reader of such files, too:
that writer holds a mebibyte back, which is a minute of joint states, and that reader wants the index, which a program
that was killed has not written.
"""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Collection, Iterator
from heapq import heappop, heappush
from io import BufferedReader
from pathlib import Path
from struct import Struct, error, pack
from typing import Any

from backports import zstd
from lz4.frame import LZ4FrameDecompressor

from tutorial.errors import printable
from tutorial.ros.bags.storage import (
    LARGEST_MESSAGE,
    LONGEST_NAME,
    LONGEST_QOS,
    MOST_FAULTS,
    MOST_TOPICS,
    Channel,
    Damaged,
    RawMessage,
)

__all__ = ["McapReader", "McapWriter"]

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = 0x0B, 0x0C, 0x0D, 0x0E, 0x0F

FOOTER_SIZE = 9 + 20 + len(MAGIC)
LARGEST_SUMMARY = 64 * 2**20  # [bytes]
LARGEST_TEXT = 2**20  # of a definition, or of other words of a record [bytes]
REORDERED = 64 * 2**20  # of messages that wait for earlier ones, at most [bytes]
CHUNK_SIZE = 768 * 1024  # [bytes], as ros2 bag's

_record_head = Struct("<BQ")
_message_head = Struct("<HIQQ")
_chunk_head = Struct("<QQQI")
_statistics = Struct("<QHIIIIQQ")


class McapWriter:
    """Writes an MCAP file. One thread.

    Args:
        path: the file, which must not be there.

    Raises:
        OSError: it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("xb", buffering=0)
        self._at = 0
        self._channels: dict[int, Channel] = {}
        self._schemas: dict[str, int] = {}  # ids by type
        self._counts: Counter[int] = Counter()
        self._start, self._end = 2**63 - 1, 0
        self._chunk = bytearray()
        self._chunk_start, self._chunk_end = 2**63 - 1, 0
        self._index: dict[int, list[tuple[int, int]]] = {}  # of the chunk: times and places of messages by channel
        self._chunk_indexes: list[bytes] = []
        self._put(MAGIC + _record(HEADER, _text("ros2") + _text("tank-tutorial")))

    def add_channel(self, channel: Channel) -> None:
        """Make a topic known before its first message."""
        if channel.type_name not in self._schemas:
            self._schemas[channel.type_name] = len(self._schemas) + 1
            self._chunk += self._schema(channel)
        self._channels[channel.id] = channel
        self._chunk += self._channel(channel)

    def write(self, channel_id: int, received_ns: int, sent_ns: int, payload: bytes) -> None:
        """Write a message; it is in the file when its chunk is full, or after `flush`."""
        self._chunk_start = min(self._chunk_start, received_ns)
        self._chunk_end = max(self._chunk_end, received_ns)
        self._index.setdefault(channel_id, []).append((received_ns, len(self._chunk)))
        sequence = self._counts[channel_id] & 0xFFFFFFFF
        self._chunk += _record(MESSAGE, _message_head.pack(channel_id, sequence, received_ns, sent_ns) + payload)
        self._counts[channel_id] += 1
        if len(self._chunk) >= CHUNK_SIZE:
            self.flush()

    def flush(self) -> None:
        """Write the messages so far as a chunk, with its index behind it."""
        if not self._index:
            return
        start, records = self._at, bytes(self._chunk)
        times = pack("<QQ", self._chunk_start, self._chunk_end)
        sizes = pack("<Q", len(records))
        self._put(_record(CHUNK, times + sizes + pack("<I", zlib.crc32(records)) + _text("") + sizes + records))
        length, offsets = self._at - start, b""
        for channel_id, places in self._index.items():
            offsets += pack("<HQ", channel_id, self._at)
            entries = b"".join(pack("<QQ", *place) for place in places)
            self._put(_record(MESSAGE_INDEX, pack("<HI", channel_id, len(entries)) + entries))
        indexed = pack("<QQI", start, length, len(offsets)) + offsets + pack("<Q", self._at - start - length)
        self._chunk_indexes.append(times + indexed + _text("") + sizes + sizes)
        self._start, self._end = min(self._start, self._chunk_start), max(self._end, self._chunk_end)
        self._chunk, self._index = bytearray(), {}
        self._chunk_start, self._chunk_end = 2**63 - 1, 0

    def close(self, metadata: str) -> None:
        """Write what is left, and the summary."""
        try:
            self.flush()
            told_at = self._at
            told = _record(METADATA, _text("rosbag2") + _map({"serialized_metadata": metadata}))
            self._put(told + _record(DATA_END, bytes(4)))
            self._put(self._summary(pack("<QQ", told_at, len(told)) + _text("rosbag2")))
        finally:
            self._file.close()

    def _summary(self, metadata_index: bytes) -> bytes:
        """Return what stands behind the data, up to the end of the file."""
        firsts = {channel.type_name: channel for channel in reversed(self._channels.values())}
        total = sum(self._counts.values())
        start = self._start if total else 0
        counts = b"".join(pack("<HQ", *item) for item in self._counts.items())
        many = (len(self._schemas), len(self._channels), 0, 1, len(self._chunk_indexes))
        groups = {
            SCHEMA: b"".join(self._schema(firsts[name]) for name in self._schemas),
            CHANNEL: b"".join(map(self._channel, self._channels.values())),
            CHUNK_INDEX: b"".join(_record(CHUNK_INDEX, index) for index in self._chunk_indexes),
            METADATA_INDEX: _record(METADATA_INDEX, metadata_index),
            STATISTICS: _record(
                STATISTICS, _statistics.pack(total, *many, start, self._end) + pack("<I", len(counts)) + counts
            ),
        }
        offsets, at = b"", self._at
        for opcode, records in groups.items():
            if records:
                offsets += _record(SUMMARY_OFFSET, pack("<BQQ", opcode, at, len(records)))
            at += len(records)
        footer = _record(FOOTER, pack("<QQI", self._at, at, 0))
        return b"".join(groups.values()) + offsets + footer + MAGIC

    def _schema(self, channel: Channel) -> bytes:
        words = _text(channel.type_name) + _text("ros2msg") + _text(channel.definition)
        return _record(SCHEMA, pack("<H", self._schemas[channel.type_name]) + words)

    def _channel(self, channel: Channel) -> bytes:
        more = {"offered_qos_profiles": channel.qos, "topic_type_hash": channel.type_hash}
        words = _text(channel.topic) + _text(channel.encoding) + _map(more)
        return _record(CHANNEL, pack("<HH", channel.id, self._schemas[channel.type_name]) + words)

    def _put(self, data: bytes) -> None:
        """Write all of it: where it fails in the middle, the disk is full."""
        rest = memoryview(data)
        while rest:
            rest = rest[self._file.write(rest) :]
        self._at += len(data)


class McapReader:
    """Reads an MCAP file, as far as it goes. See `tutorial.ros.bags.storage.FileReader`.

    Raises:
        Damaged: it is no MCAP file of ROS 2.
        OSError: it cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.channels: dict[int, Channel] = {}
        self.counts: Counter[int] = Counter()
        self.start = self.end = 0
        self.faults: list[str] = []
        self._types: dict[int, str] = {}  # names by the schema's id
        self._file: BufferedReader = path.open("rb")
        try:
            self._size = self._data_end = path.stat().st_size
            self._data_start = self._check_begin()
            if not self._read_summary():
                self._scan()
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
        for earliest, records in self._chunks(since):
            while waiting and (waiting[0][0] < earliest or held > REORDERED):
                time, _, channel_id, payload = heappop(waiting)
                held -= len(payload)
                yield channel_id, time, payload
            for channel_id, time, payload in self._messages_in(records):
                if time >= since and channel_id in wanted:
                    number, held = number + 1, held + len(payload)
                    heappush(waiting, (time, number, channel_id, payload))
        while waiting:
            time, _, channel_id, payload = heappop(waiting)
            yield channel_id, time, payload

    def _say(self, fault: str) -> None:
        if fault not in self.faults and len(self.faults) < MOST_FAULTS:
            self.faults.append(fault)

    def _check_begin(self) -> int:
        """Return where the data begin."""
        begin = self._file.read(len(MAGIC))
        if begin != MAGIC:
            raise Damaged(f"it begins with {begin.hex(' ')!r}, not as an MCAP file does" if begin else "it is empty")
        try:
            opcode, body = next(self._records(len(MAGIC), self._size))
            profile = _Words(body).text() if opcode == HEADER else ""
        except (Damaged, StopIteration):
            profile = "ros2"  # cut off at once
        if profile != "ros2":
            raise Damaged(f"it is of '{printable(profile[:60])}', not of 'ros2'")
        return self._file.tell()

    def _read_summary(self) -> bool:
        """Take topics and counts from behind the data; False where that is not possible."""
        self._file.seek(max(0, self._size - FOOTER_SIZE))
        end = self._file.read(FOOTER_SIZE)
        if not (len(end) == FOOTER_SIZE and end.endswith(MAGIC) and end[0] == FOOTER):
            self._say("its end is missing, as of a recording that was killed or filled the disk")
            return False
        begin, last = int.from_bytes(end[9:17], "little"), self._size - FOOTER_SIZE
        self._data_end = last
        if not self._data_start <= begin < last or last - begin > LARGEST_SUMMARY:
            return False  # without one, which is allowed
        self._data_end = begin
        complete = False
        try:
            for opcode, body in self._records(begin, last):
                self._take(opcode, body)
                if opcode == STATISTICS:
                    total, *_, self.start, self.end = _statistics.unpack_from(body)
                    pairs = _Words(body[_statistics.size :]).pairs()
                    self.counts = Counter({i: n for i, n in pairs if i in self.channels})
                    complete = total == sum(self.counts.values()) and 0 <= self.start <= self.end < 2**63
        except (Damaged, error):
            complete = False
        if not complete:
            self.counts.clear()
        return complete

    def _scan(self) -> None:
        """Look through the whole file for topics, and count the messages."""
        self.start, self.end = 2**63 - 1, 0
        for _, records in self._chunks(0):
            for channel_id, time, _ in self._messages_in(records):
                self.counts[channel_id] += 1
                self.start, self.end = min(self.start, time), max(self.end, time)
        if not self.counts:
            self.start = 0

    def _chunks(self, since: int) -> Iterator[tuple[int, bytes]]:
        """Yield when each chunk begins [ns], and its records; those that end before a time are left out.

        A message that stands outside of chunks is one of its own.
        """
        try:
            for opcode, body in self._records(self._data_start, self._data_end):
                if opcode == CHUNK:
                    start, end, size, crc = _chunk_head.unpack_from(body)
                    if end >= since and (records := self._unpacked(_Words(body[_chunk_head.size :]), size, crc)):
                        yield start, records
                elif opcode == MESSAGE:
                    yield _message_head.unpack_from(body)[2], _record(opcode, body)
                else:
                    self._take(opcode, body)
        except Damaged as damaged:
            self._say(str(damaged))
        except error:
            self._say("a record in it is too short")

    def _unpacked(self, words: _Words, size: int, crc: int) -> bytes:
        """Return the records of a chunk, as far as they are there; none where they cannot be unpacked."""
        try:
            compression, packed = words.text(LONGEST_NAME), words.rest(8)
            if size > LARGEST_MESSAGE:
                raise Damaged(f"a chunk in it has {size:,} bytes, and {LARGEST_MESSAGE:,} are the most that is read")
            records = _decompressed(compression, packed, size)
        except Damaged as damaged:
            self._say(str(damaged))
            return b""
        if len(records) == size and crc and zlib.crc32(records) != crc:
            self._say("a chunk in it has another checksum than it had when it was written")
        elif len(records) < size:
            self._say("a chunk in it is incomplete")
        return records

    def _messages_in(self, records: bytes) -> Iterator[RawMessage]:
        """Yield the messages of a chunk, up to where it is cut off, and learn its topics."""
        at = 0
        while at + _record_head.size <= len(records):
            opcode, size = _record_head.unpack_from(records, at)
            at += _record_head.size
            if size > len(records) - at:
                break
            if opcode == MESSAGE and size >= _message_head.size:
                channel_id, _, time, _ = _message_head.unpack_from(records, at)
                if channel_id in self.channels and time < 2**63:
                    yield channel_id, time, records[at + _message_head.size : at + size]
                else:
                    self._say("a message in it belongs to no topic")
            elif opcode in (SCHEMA, CHANNEL):
                self._take(opcode, records[at : at + size])
            at += size
        if at < len(records):
            self._say("a chunk in it is incomplete")

    def _records(self, begin: int, end: int) -> Iterator[tuple[int, bytes]]:
        """Yield kind and content of each record that is of interest; of a chunk that is cut off, what is there."""
        at = begin
        while at < end:
            self._file.seek(at)
            head = self._file.read(_record_head.size)
            if len(head) < _record_head.size:
                raise Damaged("it ends in the middle of a record")
            opcode, size = _record_head.unpack(head)
            at += len(head) + size
            limit = LARGEST_MESSAGE + 64 if opcode in (CHUNK, MESSAGE) else LARGEST_TEXT
            if opcode not in (HEADER, SCHEMA, CHANNEL, MESSAGE, CHUNK, STATISTICS):
                if at > end:
                    raise Damaged("it ends in the middle of a record")
                continue
            if size > limit:
                raise Damaged(f"a record in it has {size:,} bytes, and {limit:,} are the most that is read")
            body = self._file.read(size)
            if len(body) == size or opcode == CHUNK:
                yield opcode, body
            if len(body) < size:
                raise Damaged("it ends in the middle of a record")

    def _take(self, opcode: int, body: bytes) -> None:
        """Learn a topic, or what its messages are; what cannot be read is said, and left out."""
        try:
            if opcode == SCHEMA and len(self._types) < MOST_TOPICS:
                self._types[int.from_bytes(body[:2], "little")] = _Words(body[2:]).text(LONGEST_NAME)
            elif opcode == CHANNEL:
                self._take_channel(body)
        except Damaged as damaged:
            self._say(str(damaged))

    def _take_channel(self, body: bytes) -> None:
        number, schema = (int.from_bytes(body[i : i + 2], "little") for i in (0, 2))
        if len(self.channels) >= MOST_TOPICS and number not in self.channels:
            raise Damaged(f"it has more than {MOST_TOPICS:,} topics; the others are left out")
        words = _Words(body[4:])
        topic, encoding = words.text(LONGEST_NAME), words.text(LONGEST_NAME)
        more = dict(words.texts())
        qos, type_hash = more.get("offered_qos_profiles", ""), more.get("topic_type_hash", "")
        type_name = self._types.get(schema, "")
        self.channels[number] = Channel(
            number, topic, type_name, encoding, qos[:LONGEST_QOS], type_hash=type_hash[:LONGEST_NAME]
        )


class _Words:
    """Reads the parts of a record, one after the other."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def rest(self, width: int = 4) -> bytes:
        """Take bytes that stand behind their number, whose width is given, or as many as there are."""
        begin = self._at + width
        self._at = begin + int.from_bytes(self._data[self._at : begin], "little")
        return self._data[begin : self._at]

    def text(self, longest: int = LARGEST_TEXT) -> str:
        """Take a text."""
        taken = self.rest()
        if self._at > len(self._data):
            raise Damaged("a record in it ends in the middle of a word")
        if len(taken) > longest:
            raise Damaged(f"a name in it has {len(taken):,} characters, and {longest:,} are the most that is read")
        return taken.decode("utf-8", "backslashreplace")

    def texts(self) -> Iterator[tuple[str, str]]:
        """Take a map of texts."""
        words = _Words(self.rest())
        while words._at < len(words._data):
            yield words.text(), words.text()

    def pairs(self) -> Iterator[tuple[int, int]]:
        """Take a map from channels to numbers."""
        yield from Struct("<HQ").iter_unpack(self.rest())


def _decompressed(compression: str, packed: bytes, size: int) -> bytes:
    """Return so many bytes at most, or those that are there of data that are cut off."""
    if not compression:
        return packed[:size]
    decompressor: Any = {"zstd": zstd.ZstdDecompressor, "lz4": LZ4FrameDecompressor}.get(compression)
    if decompressor is None:
        raise Damaged(f"a chunk in it is compressed by '{printable(compression[:20])}', and not by zstd or lz4")
    try:
        return bytes(decompressor().decompress(packed, max_length=size))
    except (zstd.ZstdError, RuntimeError, EOFError, ValueError) as wrong:
        raise Damaged(f"a chunk in it cannot be unpacked: {printable(str(wrong))}") from wrong


def _record(opcode: int, body: bytes) -> bytes:
    return _record_head.pack(opcode, len(body)) + body


def _text(text: str) -> bytes:
    data = text.encode("utf-8", "backslashreplace")
    return pack("<I", len(data)) + data


def _map(texts: dict[str, str]) -> bytes:
    data = b"".join(_text(key) + _text(value) for key, value in texts.items())
    return pack("<I", len(data)) + data
