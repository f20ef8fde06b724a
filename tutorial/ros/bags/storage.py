"""What the two kinds of file that a bag is made of, MCAP and SQLite, have in common."""

from dataclasses import dataclass
from typing import Any

import yaml

LARGEST_MESSAGE = 128 * 2**20
"""Of a message, or of a chunk of messages, when it is unpacked [bytes]: some five pictures of the largest cameras."""

RawMessage = tuple[str, int, bytes]
"""Its topic, when it was received [ns], and its payload."""


class CorruptBagError(Exception):
    """Nothing in a file can be read. The text completes a sentence that begins with the file's name."""


@dataclass
class Span:
    """How many messages there are, and when the first and the last of them was received [ns]; 0 without messages."""

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
    """What a bag holds of a topic, beside its messages.

    Attributes:
        topic: its full name.
        type_name: such as ``"sensor_msgs/msg/Joy"``.
        encoding: of its payloads; ``"cdr"`` in ROS 2.
        qos: what its publishers offered, as YAML.
        definition: the message type's, with those that it is made of, as text; only for writing.
        type_hash: of the message type (REP 2016); only for writing.
    """

    topic: str
    type_name: str
    encoding: str = "cdr"
    qos: str = ""
    definition: str = ""
    type_hash: str = ""


class _Loader(yaml.SafeLoader):
    """Merges no mappings: a few that are merged into each other unfold to gigabytes."""

    def flatten_mapping(self, node: yaml.MappingNode) -> None:
        """Leave a mapping as it is."""


_Loader.add_constructor("tag:yaml.org,2002:int", lambda _loader, node: int(node.value))
"""Numbers in a bag are decimal. Python reads others of any length, which it then cannot print."""


def read_yaml(text: str | bytes) -> Any:
    """Read what a bag has in YAML. PyYAML's faster loader, in C, ends the process on text that is nested too deeply.

    Raises:
        Exception: it is no YAML; whoever wrote it, it may be anything.
    """
    return yaml.load(text, Loader=_Loader)
