"""A bag that is being written: a folder of one file or several, and what they have in common."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from textwrap import indent

from tutorial.errors import TutorialError, did_you_mean
from tutorial.ros.bags.mcap import McapWriter
from tutorial.ros.bags.metadata import TITLE, FileInfo, metadata_text
from tutorial.ros.bags.sqlite import SqliteWriter
from tutorial.ros.bags.storage import SUFFIXES, Channel, FileWriter

__all__ = ["BagWriter"]

WRITERS: dict[str, Callable[[Path], FileWriter]] = {"mcap": McapWriter, "sqlite3": SqliteWriter}


class BagWriter:
    """Writes a bag as ``ros2 bag record`` lays it out. One thread at a time.

    Args:
        path: the bag's folder, which must not be there: nothing is overwritten.
        storage: ``"mcap"`` or ``"sqlite3"``.
        max_duration: after how long to begin another file [s]; None for one file.

    Attributes:
        counts: how many messages of each topic are written.

    Raises:
        TutorialError: there is something of this name, or it cannot be made.
    """

    def __init__(self, path: Path, storage: str = "mcap", max_duration: float | None = None) -> None:
        if storage not in WRITERS:
            raise TutorialError(f"there is no storage {storage!r}.{did_you_mean(storage, WRITERS)}")
        if max_duration is not None and not max_duration > 0:
            raise TutorialError(f"the longest duration of a file is {max_duration} s; give one above 0.")
        self.path = path
        self.counts: Counter[str] = Counter()
        self._storage = storage
        self._span_ns = None if max_duration is None else int(max_duration * 1e9)
        self._channels: dict[int, Channel] = {}
        self._known: set[int] = set()  # channels of the file that is being written
        self._written: Counter[int] = Counter()
        self._files: list[FileInfo] = []
        try:
            path.mkdir(parents=True)
            self._file = self._next_file()
        except FileExistsError:
            raise TutorialError(
                f"there is a {str(path)!r} already, and a bag overwrites nothing. Give another name."
            ) from None
        except OSError as error:
            raise TutorialError(f"the bag {str(path)!r} cannot be written: {error.strerror}.") from error

    @property
    def start(self) -> int:
        """When the first message was received [ns]; 0 before it."""
        return self._files[0].start

    @property
    def end(self) -> int:
        """When the last message was received [ns]; 0 before the first."""
        return max(file.end for file in self._files)

    def add_channel(self, channel: Channel) -> None:
        """Make a topic known before its first message."""
        self._channels[channel.id] = channel
        self._add(channel)

    def write(self, channel_id: int, received_ns: int, sent_ns: int, payload: bytes) -> None:
        """Write a message.

        Raises:
            OSError: it cannot be written.
        """
        info = self._files[-1]
        if self._span_ns is not None and info.count and received_ns - info.start >= self._span_ns:
            self._file.close(self._metadata())
            self._file = self._next_file()
            info = self._files[-1]
        if channel_id not in self._known:
            self._add(self._channels[channel_id])
        self._file.write(channel_id, received_ns, sent_ns, payload)
        info.add(received_ns)
        self._written[channel_id] += 1
        self.counts[self._channels[channel_id].topic] += 1

    def flush(self) -> None:
        """Give what is written to the operating system: it outlives this process."""
        self._file.flush()

    def close(self) -> None:
        """Complete the bag.

        Raises:
            OSError: it cannot be written.
        """
        metadata = self._metadata()
        self._file.close(metadata)
        (self.path / "metadata.yaml").write_text(f"{TITLE}:\n{indent(metadata, '  ')}", encoding="utf-8")

    def _add(self, channel: Channel) -> None:
        self._file.add_channel(channel)
        self._known.add(channel.id)

    def _next_file(self) -> FileWriter:
        name = f"{self.path.name}_{len(self._files)}{SUFFIXES[self._storage]}"
        self._files.append(FileInfo(name))
        self._known = set()
        return WRITERS[self._storage](self.path / name)

    def _metadata(self) -> str:
        return metadata_text(self._storage, self._channels.values(), self._written, self._files)
