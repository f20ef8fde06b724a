"""Convert QoS profiles to and from the YAML text in a bag."""

from collections.abc import Iterable
from typing import Any

import msgspec
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rosbags.interfaces import Qos, QosTime
from rosbags.rosbag2.metadata import dump_qos_v9, parse_qos

from tutorial.ros.bags.storage import read_yaml

DEFAULT_DEPTH = 10
FOREVER = 2**63 - 1  # [ns]
POLICIES: dict[str, Any] = {
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
OFFERED = ("RELIABLE", "BEST_EFFORT", "VOLATILE", "TRANSIENT_LOCAL", "AUTOMATIC", "MANUAL_BY_TOPIC")
SPANS = ("deadline", "lifespan", "liveliness_lease_duration")


def qos_text(profiles: Iterable[QoSProfile]) -> str:
    """Convert the QoS that publishers offer to the YAML text that a bag stores."""
    return msgspec.yaml.encode(dump_qos_v9([_told(profile) for profile in profiles])).decode()


def offered(text: str) -> QoSProfile:
    """Return the QoS to play a topic with: its publishers' QoS if they all offered the same QoS, otherwise the default.

    The depth is always the default, as in ``ros2 bag play``.

    Args:
        text: the YAML text; older versions of ``ros2 bag`` write numbers instead of words.
    """
    try:
        kinds = [_profile(told) for told in parse_qos(read_yaml(text))]
    except Exception:  # noqa: BLE001 - invalid text can raise anything
        kinds = []
    return kinds[0] if kinds and all(kind == kinds[0] for kind in kinds) else QoSProfile(depth=DEFAULT_DEPTH)


def _told(profile: Any) -> Qos:
    deadline, lifespan, lease = (QosTime(*divmod(getattr(profile, name).nanoseconds, 10**9)) for name in SPANS)
    policies = profile.reliability, profile.durability, deadline, lifespan, profile.liveliness, lease
    return Qos(profile.history, profile.depth, *policies, bool(profile.avoid_ros_namespace_conventions))


def _profile(told: Qos) -> QoSProfile:
    """Return a profile in which defaults replace values that no publisher can offer."""
    words = {name: getattr(told, name).name for name in POLICIES}
    spans = {name: getattr(told, name).sec * 10**9 + getattr(told, name).nsec for name in SPANS}
    known = {name: POLICIES[name][word] for name, word in words.items() if word in OFFERED}
    finite = {name: Duration(nanoseconds=span) for name, span in spans.items() if 0 < span < FOREVER}
    return QoSProfile(depth=DEFAULT_DEPTH, **known, **finite)
