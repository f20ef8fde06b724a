"""A bag's ``metadata.yaml``, and the quality of service that it keeps of each topic."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rosbags.interfaces import Qos, QosTime
from rosbags.rosbag2.metadata import dump_qos_v9, parse_qos

from tutorial.ros.bags.storage import Channel, Damaged

__all__ = ["TITLE", "FileInfo", "metadata_text", "offered", "qos_text", "read_metadata"]

VERSION = 9  # of Jazzy
TITLE = "rosbag2_bagfile_information"
LARGEST = 2**20  # [bytes]
DEFAULT_DEPTH = 10
FOREVER = 2**63 - 1  # [ns]
POLICIES: dict[str, Any] = {
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
    return _dumped(dump_qos_v9([_told(profile) for profile in profiles]))


def offered(text: str) -> QoSProfile:
    """Return what to offer when a topic is played: what its publishers offered if that is the same, else the default.

    The depth is the default, as that of ``ros2 bag play``.

    Args:
        text: of `qos_text`, or of an older ``ros2 bag``, which has numbers for words.
    """
    try:
        kinds = [_profile(told) for told in parse_qos(text)]
    except Exception:  # noqa: BLE001 - what a stranger has written may be anything
        kinds = []
    return kinds[0] if kinds and all(kind == kinds[0] for kind in kinds) else QoSProfile(depth=DEFAULT_DEPTH)


def _dumped(content: Any) -> str:
    return str(yaml.dump(content, Dumper=_Dumper, sort_keys=False))


def _loaded(data: bytes) -> Any:
    """Return what a YAML says; None where it is none, or too large."""
    try:
        return yaml.load(data, _Loader) if len(data) <= LARGEST else None
    except (yaml.YAMLError, ValueError, RecursionError):
        return None


def _told(profile: Any) -> Qos:
    deadline, lifespan, lease = (QosTime(*divmod(getattr(profile, name).nanoseconds, 10**9)) for name in SPANS)
    policies = profile.reliability, profile.durability, deadline, lifespan, profile.liveliness, lease
    return Qos(profile.history, profile.depth, *policies, bool(profile.avoid_ros_namespace_conventions))


def _profile(told: Qos) -> QoSProfile:
    """Return a profile; what no publisher can offer is the default."""
    profile = QoSProfile(depth=DEFAULT_DEPTH)
    for name, kind in POLICIES.items():
        word = getattr(told, name).name
        if word in kind.__members__ and word not in ("UNKNOWN", "SYSTEM_DEFAULT", "BEST_AVAILABLE"):
            setattr(profile, name, kind[word])
    for name in SPANS:
        seconds, nanoseconds = getattr(told, name)
        span = seconds * 10**9 + nanoseconds
        setattr(profile, name, Duration(nanoseconds=span if 0 < span < FOREVER else 0))
    return profile
