"""Quality of service: how hard the middleware tries to deliver messages."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from rclpy.duration import Duration, Infinite

__all__ = [
    "DurabilityPolicy",
    "HistoryPolicy",
    "InvalidQoSProfileException",
    "LivelinessPolicy",
    "QoSDurabilityPolicy",
    "QoSHistoryPolicy",
    "QoSLivelinessPolicy",
    "QoSPresetProfiles",
    "QoSProfile",
    "QoSReliabilityPolicy",
    "ReliabilityPolicy",
    "qos_profile_default",
    "qos_profile_parameter_events",
    "qos_profile_rosout_default",
    "qos_profile_sensor_data",
    "qos_profile_system_default",
]


class InvalidQoSProfileException(Exception):  # noqa: N818  (rclpy's name)
    """A profile was made of settings that don't go together."""

    def __init__(self, *args: Any) -> None:
        super().__init__("Invalid QoSProfile", *args)


class QoSPolicyEnum(IntEnum):
    """Base of the policies; their numbers are those of rmw."""

    @property
    def short_key(self) -> str:
        """The name that the ``ros2`` command uses, such as ``"best_effort"``."""
        return self.name.lower()


class HistoryPolicy(QoSPolicyEnum):
    """Which messages are kept until they are taken."""

    SYSTEM_DEFAULT = 0
    KEEP_LAST = 1
    KEEP_ALL = 2
    UNKNOWN = 3


class ReliabilityPolicy(QoSPolicyEnum):
    """Whether lost messages are sent again."""

    SYSTEM_DEFAULT = 0
    RELIABLE = 1
    BEST_EFFORT = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class DurabilityPolicy(QoSPolicyEnum):
    """Whether a subscription that comes late receives earlier messages."""

    SYSTEM_DEFAULT = 0
    TRANSIENT_LOCAL = 1
    VOLATILE = 2
    UNKNOWN = 3
    BEST_AVAILABLE = 4


class LivelinessPolicy(QoSPolicyEnum):
    """How a publisher shows that it is alive."""

    SYSTEM_DEFAULT = 0
    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3
    UNKNOWN = 4
    BEST_AVAILABLE = 5


QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy


@dataclass(kw_only=True)
class QoSProfile:
    """A set of policies.

    Attributes:
        history: which messages are kept.
        depth: how many, for ``KEEP_LAST``.
        reliability: whether lost messages are sent again.
        durability: whether a subscription that comes late receives earlier messages.
        lifespan: age at which a message is dropped.
        deadline: longest time expected between two messages.
        liveliness: how a publisher shows that it is alive.
        liveliness_lease_duration: time after which a silent publisher counts as gone.

    Raises:
        InvalidQoSProfileException: neither history nor depth is given, or no depth for ``KEEP_LAST``.
        ValueError: the depth is negative.
    """

    history: HistoryPolicy = None  # type: ignore[assignment]  # KEEP_LAST if there is a depth
    depth: int = None  # type: ignore[assignment]  # 0 if it does not matter
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
    lifespan: Duration = Infinite
    deadline: Duration = Infinite
    liveliness: LivelinessPolicy = LivelinessPolicy.AUTOMATIC
    liveliness_lease_duration: Duration = Infinite

    def __post_init__(self) -> None:
        history: Any = self.history
        depth: Any = self.depth
        if depth is None and history is None:
            raise InvalidQoSProfileException("History and/or depth settings are required.")
        if depth is None and history == HistoryPolicy.KEEP_LAST:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        if depth is not None and depth < 0:
            raise ValueError("history depth must be greater than or equal to zero")
        self.history = HistoryPolicy.KEEP_LAST if history is None else HistoryPolicy(history)
        self.depth = depth or 0
        self.reliability = ReliabilityPolicy(self.reliability)
        self.durability = DurabilityPolicy(self.durability)
        self.liveliness = LivelinessPolicy(self.liveliness)


def profile_of(qos_profile: QoSProfile | int) -> QoSProfile:
    """Return the profile that a program means: an int is the depth of the default one.

    Raises:
        ValueError: it is a negative int.
        TypeError: it is something else.
    """
    if isinstance(qos_profile, QoSProfile):
        return qos_profile
    if isinstance(qos_profile, int):
        return QoSProfile(depth=qos_profile)
    raise TypeError(f"Expected QoSProfile or int, but received {type(qos_profile)!r}")


qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = QoSProfile(
    history=HistoryPolicy.SYSTEM_DEFAULT,
    reliability=ReliabilityPolicy.SYSTEM_DEFAULT,
    durability=DurabilityPolicy.SYSTEM_DEFAULT,
    liveliness=LivelinessPolicy.SYSTEM_DEFAULT,
)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_rosout_default = QoSProfile(
    depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL, lifespan=Duration(seconds=10)
)


class QoSPresetProfiles:
    """The ready-made profiles, as attributes."""

    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    PARAMETER_EVENTS = qos_profile_parameter_events
