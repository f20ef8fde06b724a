"""Convert rclpy's QoS profiles to Cyclone DDS's policies, and back."""

from _rosidl.definitions import type_hash
from _rosidl.message import Message
from cyclonedds.qos import Policy, Qos
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

FOREVER = 2**63 - 1
UNLIMITED = -1
INCOMPATIBLE_TYPE = 24
POLICY_NAMES = {2: "DURABILITY", 4: "DEADLINE", 8: "LIVELINESS", 11: "RELIABILITY"}
"""Numbers in DDS of the policies that can make a publisher and a subscription incompatible."""


def to_dds(profile: QoSProfile, msg_type: type[Message], *, writer: bool) -> Qos:
    """Return the DDS policies of a writer or reader.

    Args:
        profile: the requested QoS; "best available" means the most for a writer, the least for a reader.
        msg_type: class of the messages; its hash is announced with the endpoint.
        writer: whether the policies are for a writer.

    Raises:
        TypeError: the depth is negative.
    """
    if profile.depth < 0:
        raise TypeError(f"QoSProfile: depth is {profile.depth}, must not be negative")
    keep_all = profile.history == HistoryPolicy.KEEP_ALL
    history = Policy.History.KeepAll if keep_all else Policy.History.KeepLast(profile.depth or 1)
    best_effort = profile.reliability.name in (["BEST_EFFORT"] if writer else ["BEST_EFFORT", "BEST_AVAILABLE"])
    kept = profile.durability.name in (["TRANSIENT_LOCAL", "BEST_AVAILABLE"] if writer else ["TRANSIENT_LOCAL"])
    manual = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    liveliness = Policy.Liveliness.ManualByTopic if manual else Policy.Liveliness.Automatic
    policies = [
        Policy.Userdata(f"typehash={type_hash(msg_type._definition.type_name)};".encode()),  # otherwise ROS 2 warns
        history,
        Policy.Reliability.BestEffort if best_effort else Policy.Reliability.Reliable(FOREVER),
        Policy.Durability.TransientLocal if kept else Policy.Durability.Volatile,
        Policy.Deadline(_span(profile.deadline)),
        liveliness(_span(profile.liveliness_lease_duration)),
    ]
    if kept:
        policies.append(Policy.DurabilityService(0, history, UNLIMITED, UNLIMITED, UNLIMITED))
    if writer:
        policies += [Policy.Lifespan(_span(profile.lifespan)), Policy.WriterDataLifecycle(autodispose=False)]
    return Qos(*policies)


def from_dds(qos: Qos) -> QoSProfile:
    """Return the profile of a discovered endpoint."""
    history, liveliness = qos[Policy.History], qos[Policy.Liveliness]
    last = isinstance(history, Policy.History.KeepLast)
    reliable = isinstance(qos[Policy.Reliability], Policy.Reliability.Reliable)
    volatile = qos[Policy.Durability] == Policy.Durability.Volatile
    manual = isinstance(liveliness, Policy.Liveliness.ManualByTopic)
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST if last else HistoryPolicy.KEEP_ALL,
        depth=history.depth if last else 0,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE if volatile else DurabilityPolicy.TRANSIENT_LOCAL,
        lifespan=Duration(nanoseconds=qos[Policy.Lifespan].lifespan if Policy.Lifespan in qos else FOREVER),
        deadline=Duration(nanoseconds=qos[Policy.Deadline].deadline if Policy.Deadline in qos else FOREVER),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC if manual else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(nanoseconds=liveliness.lease_duration if liveliness else FOREVER),
    )


def _span(duration: Duration) -> int:
    """Return a duration for DDS [ns]; 0 and "best available" mean no limit."""
    nanoseconds = duration.nanoseconds
    return nanoseconds if 0 < nanoseconds < FOREVER - 1 else FOREVER
