"""Write a bag: a folder with one or more files and their common metadata."""

import math
from collections import Counter
from pathlib import Path
from typing import Any

import msgspec

from tutorial.errors import TutorialError
from tutorial.ros.bags.mcap import McapWriter
from tutorial.ros.bags.sqlite import SqliteWriter
from tutorial.ros.bags.storage import Channel, Span, read_yaml

WRITERS: dict[str, tuple[str, type[McapWriter | SqliteWriter]]] = {
    "mcap": (".mcap", McapWriter),
    "sqlite3": (".db3", SqliteWriter),
}
VERSION = 9  # version of the metadata format in Jazzy


class BagWriter:
    """Writes a bag in the layout that ``ros2 bag record`` uses. Use it from only one thread at a time.

    Args:
        path: the bag's folder, which must not exist: nothing is overwritten.
        storage: ``"mcap"`` or ``"sqlite3"``.
        max_duration: maximum duration of each file [s]; after that, the next file is started.

    Attributes:
        counts: number of messages written so far, by topic.

    Raises:
        TutorialError: the path exists, is not valid UTF-8, or cannot be created.
    """

    def __init__(self, path: Path, storage: str = "mcap", max_duration: float = math.inf) -> None:
        self.path = path
        self.counts: Counter[str] = Counter()
        self._storage = storage
        self._longest_ns = max_duration * 1e9
        self._channels: list[Channel] = []
        self._span = Span()
        self._files: dict[str, Span] = {}
        try:
            str(path).encode()  # the bag stores its own name, in UTF-8
            path.mkdir(parents=True)
            self._begin_file()
        except UnicodeEncodeError:
            raise TutorialError(f"the bag's name, {str(path)!r}, is not UTF-8. Choose a different name.") from None
        except FileExistsError:
            raise TutorialError(
                f"{str(path)!r} already exists, and a recording never overwrites files. Choose a different name."
            ) from None
        except OSError as error:
            raise TutorialError(f"the bag {str(path)!r} cannot be written: {error.strerror}.") from error

    @property
    def duration(self) -> float:
        """Time from the first message to the last one [s]."""
        return (self._span.end - self._span.start) / 1e9

    def add_channel(self, channel: Channel) -> None:
        """Register a topic before its first message.

        Raises:
            OSError: the bag cannot be written.
        """
        self._channels.append(channel)
        self._file.add_channel(channel)

    def write(self, topic: str, received_ns: int, sent_ns: int, payload: bytes) -> None:
        """Write a message.

        Raises:
            OSError: the bag cannot be written.
        """
        if self._file_span.count and received_ns - self._file_span.start >= self._longest_ns:
            self._file.close(_yaml(self._information()))
            self._begin_file()
        self._file.write(topic, received_ns, sent_ns, payload)
        self._file_span.add(received_ns)
        self._span.add(received_ns)
        self.counts[topic] += 1

    def flush(self) -> None:
        """Pass the written messages to the operating system, so that they are not lost if this process is killed."""
        self._file.flush()

    def close(self) -> None:
        """Complete the bag.

        Raises:
            OSError: the bag cannot be written.
        """
        information = self._information()
        self._file.close(_yaml(information))
        metadata = _yaml({"rosbag2_bagfile_information": information})
        (self.path / "metadata.yaml").write_text(metadata, encoding="utf-8")

    def _begin_file(self) -> None:
        suffix, writer = WRITERS[self._storage]
        name = f"{self.path.name}_{len(self._files)}{suffix}"
        self._file = writer(self.path / name)
        self._file_span = self._files[name] = Span()
        for channel in self._channels:
            self._file.add_channel(channel)

    def _information(self) -> dict[str, Any]:
        """Return the bag's metadata so far."""
        topics = [
            {
                "topic_metadata": {
                    "name": channel.topic,
                    "type": channel.type_name,
                    "serialization_format": channel.encoding,
                    "offered_qos_profiles": read_yaml(channel.qos) or [],
                    "type_description_hash": channel.type_hash,
                },
                "message_count": self.counts[channel.topic],
            }
            for channel in self._channels
        ]
        return {
            "version": VERSION,
            "storage_identifier": self._storage,
            **_told(self._span),
            "topics_with_message_count": topics,
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": list(self._files),
            "files": [{"path": name, **_told(span)} for name, span in self._files.items()],
            "custom_data": None,
            "ros_distro": "jazzy",
        }


def _told(span: Span) -> dict[str, Any]:
    return {
        "starting_time": {"nanoseconds_since_epoch": span.start},
        "duration": {"nanoseconds": span.end - span.start},
        "message_count": span.count,
    }


def _yaml(content: Any) -> str:
    return msgspec.yaml.encode(content).decode()
