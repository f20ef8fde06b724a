"""Types and limits shared by the two kinds of bag files, MCAP and SQLite."""

from dataclasses import dataclass
from typing import Any

import yaml

LARGEST_MESSAGE = 128 * 2**20
"""Maximum size of a message, or of a chunk once decompressed [bytes]: about five images from the largest cameras."""

RawMessage = tuple[str, int, bytes]
"""A message's topic, time of receipt [ns] and payload."""


class CorruptBagError(Exception):
    """Raised if nothing in a file can be read. The text completes a sentence that begins with the file's name."""


@dataclass
class Span:
    """The number of messages, and when the first and last of them were received [ns]; all 0 if there are none."""

    count: int = 0
    start: int = 0
    end: int = 0

    def add(self, time: int) -> None:
        """Add a message."""
        self.start = min(self.start, time) if self.count else time
        self.end = max(self.end, time) if self.count else time
        self.count += 1


@dataclass(frozen=True)
class Channel:
    """A bag's metadata for a topic.

    Attributes:
        topic: its full name.
        type_name: its type, such as ``"sensor_msgs/msg/Joy"``.
        encoding: encoding of its payloads; ``"cdr"`` in ROS 2.
        qos: the QoS that its publishers offered, as YAML.
        definition: text that defines the message type and the types it uses; only for writing.
        type_hash: hash of the message type (REP 2016); only for writing.
    """

    topic: str
    type_name: str
    encoding: str = "cdr"
    qos: str = ""
    definition: str = ""
    type_hash: str = ""


class _Loader(yaml.SafeLoader):
    """YAML loader that ignores merge keys, because a few keys that refer to each other can expand to gigabytes."""

    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        """Leave a mapping unchanged."""


_Loader.add_constructor("tag:yaml.org,2002:int", lambda _loader, node: int(node.value))
"""Integers in a bag's YAML are decimal.

In other bases, Python would accept a number of any length, and might then be unable to print it.
"""


def read_yaml(text: str | bytes) -> Any:
    """Read YAML text from a bag, without PyYAML's faster loader: its C code crashes on deeply nested text.

    Raises:
        Exception: the text is not valid YAML; the exception can be of any type.
    """
    return yaml.load(text, Loader=_Loader)
