"""Read and write MCAP files, the default format of ``ros2 bag`` (https://mcap.dev/spec).

A file is a sequence of records. Messages are grouped in chunks, and a summary of the file follows the last chunk. The
package mcap reads and writes individual records. Its file reader, like the reader in rosbags, needs a complete file;
this module can also read an incomplete file, such as one left by a killed program or a failing disk.
"""

import struct
import zlib
from collections.abc import Callable, Iterable, Iterator
from io import BytesIO
from pathlib import Path
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
from tutorial.ros.bags.storage import LARGEST_MESSAGE, Channel, CorruptBagError, RawMessage

CHUNK_SIZE = 768 * 1024  # [bytes], as in ros2 bag
LARGEST_RECORD = LARGEST_MESSAGE + 64  # [bytes], including the fields before the messages
HEAD = struct.Struct("<BQ")  # start of a record: its kind and its length

KINDS: dict[int, Any] = {
    Opcode.FOOTER: records.Footer,
    Opcode.SCHEMA: records.Schema,
    Opcode.CHANNEL: records.Channel,
    Opcode.MESSAGE: records.Message,
    Opcode.CHUNK: records.Chunk,
}
"""Classes of the records that are read, by opcode; other records are skipped."""

DECOMPRESSORS: dict[str, Callable[[bytes, int], bytes]] = {
    "": lambda data, size: data[:size],
    "zstd": lambda data, size: zstd.ZstdDecompressor().decompress(data, max_length=size),
    "lz4": lambda data, size: LZ4FrameDecompressor().decompress(data, max_length=size),
}
"""Decompressors that stop at a given length, unlike the decompressors in the package mcap."""

CUT_CHUNK = "a chunk in it is incomplete"
CUT_OFF = "it ends in the middle of a record"
UNREADABLE = (EndOfFile, struct.error, UnicodeDecodeError, OverflowError)  # raised for a damaged record


class McapWriter:
    """Writes an MCAP file. Use it from a single thread.

    Args:
        path: the file, which must not exist.

    Raises:
        OSError: the file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("xb")
        self._writer = Writer(self._file, CHUNK_SIZE, CompressionType.NONE)
        self._schemas: dict[str, int] = {}  # schema ids by type
        self._ids: dict[str, int] = {}  # channel ids by topic
        self._writer.start("ros2", "tank-tutorial")
        self._writer.flush()

    def add_channel(self, channel: Channel) -> None:
        """Register a topic before its first message."""
        kind = channel.type_name
        if kind not in self._schemas:
            self._schemas[kind] = self._writer.register_schema(kind, "ros2msg", channel.definition.encode())
        words = {"offered_qos_profiles": channel.qos, "topic_type_hash": channel.type_hash}
        topic = channel.topic
        self._ids[topic] = self._writer.register_channel(topic, channel.encoding, self._schemas[kind], words)

    def write(self, topic: str, received_ns: int, sent_ns: int, payload: bytes) -> None:
        """Write a message. It reaches the file no later than the next `flush`."""
        self._writer.add_message(self._ids[topic], received_ns, payload, sent_ns)

    def flush(self) -> None:
        """Write the messages collected so far as a chunk, followed by its index."""
        self._writer.flush()

    def close(self, metadata: str) -> None:
        """Write the remaining messages, the bag's metadata and the summary."""
        with self._file:
            self._writer.flush()
            self._writer.add_metadata("rosbag2", {"serialized_metadata": metadata})
            self._writer.finish()


class McapReader:
    """Reads an MCAP file, or as much of it as possible if it is damaged. The file is open only while it is being read.

    Args:
        path: the file.
        say: called with a description of each fault that is found; the description completes a sentence.

    Attributes:
        channels: the topics found in the file so far, by id.

    Raises:
        CorruptBagError: the file is not an MCAP file.
        OSError: the file cannot be read.
    """

    def __init__(self, path: Path, say: Callable[[str], object]) -> None:
        self.channels: dict[int, Channel] = {}
        self._path = path
        self._say = say
        self._types: dict[int, str] = {}  # type names by schema id
        self._end = path.stat().st_size  # the end of the records
        with path.open("rb") as file:
            self._check_begin(file)
            end = file.seek(self._end - len(MCAP0_MAGIC))
            if file.read() != MCAP0_MAGIC:
                say("its end is missing, as happens if the recorder is killed or fills the disk")
                return
            self._end = end
            footer = next(self._records(file, max(end - FOOTER_SIZE, 0), end), None)
            if isinstance(footer, records.Footer) and footer.summary_start:
                for record in self._records(file, footer.summary_start, end):
                    self._take(record)

    def batches(self, since: float) -> Iterator[Iterable[RawMessage]]:
        """Yield the messages of each chunk, except for chunks that end before a time [ns].

        A message outside a chunk forms a separate batch.
        """
        try:
            with self._path.open("rb") as file:
                for record in self._records(file, len(MCAP0_MAGIC), self._end):
                    if not isinstance(record, records.Chunk):
                        yield self._messages_in([record])
                    elif record.message_end_time >= since:
                        yield self._messages_in(self._unpacked(record))
        except OSError as error:
            self._say(str(error))

    def _check_begin(self, file: IO[bytes]) -> None:
        """Reject a file that is not MCAP. Ignore the header's profile, which some programs omit."""
        begin = file.read(len(MCAP0_MAGIC))
        if begin != MCAP0_MAGIC:
            raise CorruptBagError(f"it begins with {begin.hex(' ')!r}, unlike an MCAP file")

    def _unpacked(self, chunk: records.Chunk) -> Iterator[records.McapRecord]:
        """Yield the records of a chunk up to the point where it is cut off; nothing if it cannot be decompressed."""
        size, how = chunk.uncompressed_size, chunk.compression
        if size > LARGEST_MESSAGE:
            self._say(f"a chunk in it has {size:,} bytes; at most {LARGEST_MESSAGE:,} are read")
        elif how not in DECOMPRESSORS:
            self._say(f"a chunk in it is compressed with '{printable(how[:20])}', not with zstd or lz4")
        else:
            try:
                data = DECOMPRESSORS[how](chunk.data, size)
            except (zstd.ZstdError, RuntimeError, EOFError, ValueError) as wrong:
                self._say(f"a chunk in it cannot be unpacked: {printable(str(wrong))}")
                return
            if len(data) < size:
                self._say(CUT_CHUNK)
            elif chunk.uncompressed_crc not in (0, zlib.crc32(data)):
                self._say("a chunk in it does not match its checksum")
            yield from self._records(BytesIO(data), 0, len(data), CUT_CHUNK)

    def _messages_in(self, some: Iterable[records.McapRecord]) -> Iterator[RawMessage]:
        """Yield the messages in a sequence of records, and store their topics."""
        for record in some:
            if not isinstance(record, records.Message):
                self._take(record)
            elif record.channel_id in self.channels and record.log_time < 2**63:
                yield self.channels[record.channel_id].topic, record.log_time, record.data
            else:
                self._say("a message in it belongs to no topic")

    def _take(self, record: records.McapRecord) -> None:
        """Store a topic, or the name of a type. Ignore records that repeat an id, because they may be damaged."""
        if isinstance(record, records.Schema):
            self._types.setdefault(record.id, record.name)
        elif isinstance(record, records.Channel):
            kind, qos = self._types.get(record.schema_id, ""), record.metadata.get("offered_qos_profiles", "")
            self.channels.setdefault(record.id, Channel(record.topic, kind, record.message_encoding, qos))

    def _records(self, file: IO[bytes], begin: int, end: int, cut: str = CUT_OFF) -> Iterator[records.McapRecord]:
        """Yield each record of a known kind that can be read, including a chunk that is cut off."""
        while begin < end:
            file.seek(begin)
            head = file.read(HEAD.size)
            opcode, size = HEAD.unpack(head) if len(head) == HEAD.size else (0, 0)
            begin += HEAD.size + size
            kind = KINDS.get(opcode)
            if kind and size > LARGEST_RECORD:
                self._say(f"a record in it has {size:,} bytes; at most {LARGEST_RECORD:,} are read")
            elif kind and (begin <= end or kind is records.Chunk):
                words = _Words(BytesIO(file.read(size)))
                try:
                    yield kind.read(words, size) if kind is records.Message else kind.read(words)
                except UNREADABLE:
                    self._say("a record in it cannot be read")
        if begin > end:
            self._say(cut)


class _Words(ReadDataStream):
    """A stream of a record's content; the strings in it need not be valid UTF-8."""

    def read_prefixed_string(self) -> str:
        return self.read(self.read4()).decode("utf-8", "backslashreplace")
