"""Quality of service: rules for how the middleware delivers messages."""

import warnings
from dataclasses import MISSING, dataclass, field, fields
from enum import Enum, IntEnum
from typing import Any

from rclpy.duration import Duration

ZERO_DEPTH = (
    "A zero depth with KEEP_LAST doesn't make sense; no data could be stored. "
    "This will be interpreted as SYSTEM_DEFAULT"
)


class InvalidQoSProfileException(Exception):  # noqa: N818  (rclpy's name)
    """A QoS profile lacks a required setting."""

    def __init__(self, *args: Any) -> None:
        super().__init__("Invalid QoSProfile", *args)


class _ShortKeys(Enum):
    """An enum whose members also have the names that the ``ros2`` command uses, such as ``"best_effort"``."""

    @classmethod
    def short_keys(cls) -> list[str]:
        """Return the short names."""
        return [name.lower() for name in cls.__members__]

    @classmethod
    def get_from_short_key(cls, name: str) -> Any:
        """Return the value of the member with a given short name: a policy's number, or a profile."""
        return cls[name.upper()].value

    @property
    def short_key(self) -> str:
        """The member's name in the ``ros2`` command."""
        return self.name.lower()


class QoSPolicyEnum(_ShortKeys, IntEnum):
    """Base class of the policies, whose values are numbered as in rmw."""


class HistoryPolicy(QoSPolicyEnum):
    """Which messages a queue stores."""

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
    """Whether a late-joining subscription receives earlier messages."""

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


class _OldName:
    """A deprecated name for a policy's value; the name still works, but using it causes a warning."""

    def __init__(self, old: str, new: str) -> None:
        self._old, self._new = old, new

    def __get__(self, instance: object, policy: type[QoSPolicyEnum]) -> QoSPolicyEnum:
        kind = policy.__name__
        warnings.warn(f"{kind}.{self._old} is deprecated. Use {kind}.{self._new} instead.", stacklevel=2)
        return policy[self._new]


def _add_old_names() -> None:
    """Add deprecated names such as ``HistoryPolicy.RMW_QOS_POLICY_HISTORY_KEEP_LAST``."""
    for policy in (HistoryPolicy, ReliabilityPolicy, DurabilityPolicy, LivelinessPolicy):
        for new in policy.__members__.keys() - {"BEST_AVAILABLE"}:  # BEST_AVAILABLE has no old name
            kind = policy.__name__.removesuffix("Policy").upper()
            if policy is LivelinessPolicy and new == "UNKNOWN":
                kind = "DURABILITY"  # as in rclpy
            old = f"RMW_QOS_POLICY_{kind}_{new}"
            setattr(policy, old, _OldName(old, new))


_add_old_names()

QoSHistoryPolicy = HistoryPolicy
QoSReliabilityPolicy = ReliabilityPolicy
QoSDurabilityPolicy = DurabilityPolicy
QoSLivelinessPolicy = LivelinessPolicy


@dataclass(init=False, repr=False, slots=True)
class QoSProfile:
    """A set of policies.

    Attributes:
        history: which messages are stored.
        depth: how many messages are stored if the history is ``KEEP_LAST``.
        reliability: whether lost messages are sent again.
        durability: whether a late-joining subscription receives earlier messages.
        lifespan: maximum age of a message; 0 means no limit, here and in the durations below.
        deadline: longest expected time between messages.
        liveliness: how a publisher shows that it is alive.
        liveliness_lease_duration: how long a publisher can be silent before it is considered gone.
        avoid_ros_namespace_conventions: use the topic's name unchanged in DDS.

    Raises:
        InvalidQoSProfileException: neither history nor depth is given, or ``KEEP_LAST`` is given without a depth.
        AssertionError: a setting is of the wrong type, or is unknown.
    """

    history: HistoryPolicy = HistoryPolicy.KEEP_LAST
    depth: int = 10
    reliability: ReliabilityPolicy = ReliabilityPolicy.RELIABLE
    durability: DurabilityPolicy = DurabilityPolicy.VOLATILE
    lifespan: Duration = field(default_factory=Duration)
    deadline: Duration = field(default_factory=Duration)
    liveliness: LivelinessPolicy = LivelinessPolicy.SYSTEM_DEFAULT
    liveliness_lease_duration: Duration = field(default_factory=Duration)
    avoid_ros_namespace_conventions: bool = False

    def __init__(self, **kwargs: Any) -> None:
        assert kwargs.keys() <= DEFAULTS.keys(), f"Invalid arguments passed to constructor: {kwargs.keys()!r}"
        if not kwargs.keys() & {"history", "depth"}:
            raise InvalidQoSProfileException("History and/or depth settings are required.")
        if kwargs.get("history", HistoryPolicy.KEEP_LAST) == HistoryPolicy.KEEP_LAST and "depth" not in kwargs:
            raise InvalidQoSProfileException("History set to KEEP_LAST without a depth setting.")
        for name, value in (DEFAULTS | kwargs).items():
            setattr(self, name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in DEFAULTS:
            kind = type(DEFAULTS[name])
            is_policy = issubclass(kind, QoSPolicyEnum)
            assert isinstance(value, int if is_policy else kind)
            value = kind(value) if is_policy else value
        if name == "depth" and value == 0 and self.history == HistoryPolicy.KEEP_LAST:
            warnings.warn(ZERO_DEPTH, stacklevel=2)
        object.__setattr__(self, name, value)

    def __str__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={getattr(self, name)}' for name in DEFAULTS)})"


DEFAULTS: dict[str, Any] = {p.name: Duration() if p.default is MISSING else p.default for p in fields(QoSProfile)}


def _every_policy(name: str, **others: Any) -> QoSProfile:
    """Return a profile that uses the value called ``name`` for every policy that has a value of this name."""
    kinds = {setting: type(default) for setting, default in DEFAULTS.items() if isinstance(default, QoSPolicyEnum)}
    return QoSProfile(**{policy: kind[name] for policy, kind in kinds.items() if name in kind.__members__}, **others)


DeadlineBestAvailable = LivelinessLeaseDurationeBestAvailable = Duration(nanoseconds=2**63 - 2)

qos_profile_unknown = _every_policy("UNKNOWN", depth=0)
qos_profile_default = QoSProfile(depth=10)
qos_profile_system_default = _every_policy("SYSTEM_DEFAULT", depth=0)
qos_profile_sensor_data = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
qos_profile_services_default = QoSProfile(depth=10)
qos_profile_parameters = QoSProfile(depth=1000)
qos_profile_parameter_events = QoSProfile(depth=1000)
qos_profile_best_available = _every_policy(
    "BEST_AVAILABLE", depth=10, deadline=DeadlineBestAvailable, liveliness_lease_duration=DeadlineBestAvailable
)
qos_profile_action_status_default = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class QoSPresetProfiles(_ShortKeys):
    """The predefined profiles by name; the names of equal profiles are aliases of the same member."""

    UNKNOWN = qos_profile_unknown
    DEFAULT = qos_profile_default
    SYSTEM_DEFAULT = qos_profile_system_default
    SENSOR_DATA = qos_profile_sensor_data
    SERVICES_DEFAULT = qos_profile_services_default
    PARAMETERS = qos_profile_parameters
    PARAMETER_EVENTS = qos_profile_parameter_events
    ACTION_STATUS_DEFAULT = qos_profile_action_status_default
    BEST_AVAILABLE = qos_profile_best_available
