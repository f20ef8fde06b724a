"""A bag's ``metadata.yaml``, and the quality of service that it keeps of each topic."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

from tutorial.ros.bags.storage import Channel, Damaged

__all__ = ["TITLE", "FileInfo", "metadata_text", "offered", "qos_text", "read_metadata"]

VERSION = 9  # of Jazzy
TITLE = "rosbag2_bagfile_information"
LARGEST = 2**20  # [bytes]
DEFAULT_DEPTH = 10
FOREVER = 2**63 - 1  # [ns]
POLICIES: dict[str, Any] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
SPANS = ("deadline", "lifespan", "liveliness_lease_duration")

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # those in C are ten times as fast, and not everywhere
_Dumper: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


@dataclass
class FileInfo:
    """What there is to say of one file of a bag.

    Attributes:
        name: of the file.
        count: of messages.
        start, end: when the first and the last was received [ns].
    """

    name: str
    count: int = 0
    start: int = 0
    end: int = 0

    def add(self, time: int) -> None:
        """Count a message."""
        self.start = min(self.start, time) if self.count else time
        self.end = max(self.end, time)
        self.count += 1


def metadata_text(
    storage: str, channels: Iterable[Channel], counts: Mapping[int, int], files: Sequence[FileInfo]
) -> str:
    """Write what is to be said of a bag; each of its files holds that, and ``metadata.yaml`` below a title."""
    filled = [file for file in files if file.count]
    start = min((file.start for file in filled), default=0)
    end = max((file.end for file in filled), default=start)
    information = {
        "version": VERSION,
        "storage_identifier": storage,
        "duration": {"nanoseconds": end - start},
        "starting_time": {"nanoseconds_since_epoch": start},
        "message_count": sum(file.count for file in files),
        "topics_with_message_count": [
            {
                "topic_metadata": {
                    "name": channel.topic,
                    "type": channel.type_name,
                    "serialization_format": channel.encoding,
                    "offered_qos_profiles": yaml.load(channel.qos, _Loader) or [],
                    "type_description_hash": channel.type_hash,
                },
                "message_count": counts.get(channel.id, 0),
            }
            for channel in channels
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.name for file in files],
        "files": [
            {
                "path": file.name,
                "starting_time": {"nanoseconds_since_epoch": file.start},
                "duration": {"nanoseconds": file.end - file.start},
                "message_count": file.count,
            }
            for file in files
        ],
        "custom_data": None,
        "ros_distro": "jazzy",
    }
    return _dumped(information)


def read_metadata(path: Path) -> dict[str, Any]:
    """Read a bag's ``metadata.yaml``.

    Raises:
        Damaged: it says nothing of use; the text is the end of a sentence.
    """
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except OSError as error:
        raise Damaged(f"it cannot be read: {error.strerror}") from error
    information = _loaded(data)
    if not isinstance(information, dict):
        raise Damaged("it is no YAML" if len(data) <= LARGEST else f"it is larger than {LARGEST:,} bytes")
    found = information.get(TITLE)
    if not isinstance(found, dict):
        raise Damaged("it is not of a bag")
    return found


def qos_text(profiles: Iterable[QoSProfile]) -> str:
    """Write what publishers offer as a bag keeps it, in YAML."""
    return _dumped([_as_mapping(profile) for profile in profiles])


def offered(text: str) -> QoSProfile:
    """Return what to offer when a topic is played: what its publishers offered if that is the same, else the default.

    The depth is the default, as that of ``ros2 bag play``.

    Args:
        text: of `qos_text`, or of an older ``ros2 bag``, which has numbers for words.
    """
    profiles = _loaded(text.encode("utf-8", "replace")[:LARGEST])
    kinds = [_profile(profile) for profile in profiles[:100]] if isinstance(profiles, list) else []
    default = QoSProfile(depth=DEFAULT_DEPTH)
    return kinds[0] if kinds and all(kind == kinds[0] for kind in kinds) else default


def _dumped(content: Any) -> str:
    return str(yaml.dump(content, Dumper=_Dumper, sort_keys=False))


def _loaded(data: bytes) -> Any:
    """Return what a YAML says; None where it is none, or too large."""
    try:
        return yaml.load(data, _Loader) if len(data) <= LARGEST else None
    except (yaml.YAMLError, ValueError, RecursionError):
        return None


def _as_mapping(profile: QoSProfile) -> dict[str, Any]:
    words: dict[str, Any] = {name: getattr(profile, name).name.lower() for name in POLICIES}
    spans = {name: _span(getattr(profile, name).nanoseconds) for name in SPANS}
    return {
        "history": words["history"],
        "depth": profile.depth,
        "reliability": words["reliability"],
        "durability": words["durability"],
        "deadline": spans["deadline"],
        "lifespan": spans["lifespan"],
        "liveliness": words["liveliness"],
        "liveliness_lease_duration": spans["liveliness_lease_duration"],
        "avoid_ros_namespace_conventions": bool(profile.avoid_ros_namespace_conventions),
    }


def _span(nanoseconds: int) -> dict[str, int]:
    seconds, rest = divmod(nanoseconds, 10**9)
    return {"sec": seconds, "nsec": rest}


def _profile(words: Any) -> QoSProfile:
    """Return a profile; of what is not understood, the default."""
    profile = QoSProfile(depth=DEFAULT_DEPTH)
    if not isinstance(words, dict):
        return profile
    for name, kind in POLICIES.items():
        if name != "history":
            setattr(profile, name, _policy(kind, words.get(name), getattr(profile, name)))
    for name in SPANS:
        setattr(profile, name, _duration(words.get(name)))
    return profile


def _policy(kind: Any, word: Any, default: Any) -> Any:
    """Return a policy by its name, or by its number; one that a publisher cannot offer is the default."""
    names = {member.name.lower(): member for member in kind} | {int(member): member for member in kind}
    found = names.get(word) if isinstance(word, (str, int)) else None
    return default if found is None or found.name in ("UNKNOWN", "SYSTEM_DEFAULT", "BEST_AVAILABLE") else found


def _duration(span: Any) -> Duration:
    """Return a span of time; what is no such is none, which 0 stands for."""
    try:
        nanoseconds = int(span["sec"]) * 10**9 + int(span["nsec"])
    except (KeyError, TypeError, ValueError, OverflowError):
        nanoseconds = 0
    return Duration(nanoseconds=nanoseconds if 0 < nanoseconds < FOREVER else 0)
