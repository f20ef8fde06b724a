"""From rclpy's QoS profiles to Cyclone DDS's policies, and back."""

from __future__ import annotations

from _rosidl.definitions import type_hash
from _rosidl.message import Message
from cyclonedds.qos import Policy, Qos
from rclpy.duration import Duration
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

__all__ = ["POLICY_NAMES", "from_dds", "to_dds"]

FOREVER = 2**63 - 1
UNLIMITED = -1

POLICY_NAMES = {2: "DURABILITY", 4: "DEADLINE", 8: "LIVELINESS", 11: "RELIABILITY", 23: "DATA_REPRESENTATION"}
"""DDS's numbers of the policies that can keep a publisher and a subscription apart."""


def to_dds(profile: QoSProfile, msg_type: type[Message], *, writer: bool) -> Qos:
    """Return the policies of a writer or reader.

    Args:
        profile: what the program asks for.
        msg_type: class of the messages; its hash is announced with the endpoint.
        writer: for a writer, else for a reader.
    """
    history = (
        Policy.History.KeepAll
        if profile.history == HistoryPolicy.KEEP_ALL
        else Policy.History.KeepLast(max(profile.depth, 1))
    )
    policies = [
        Policy.Userdata(f"typehash={type_hash(msg_type._definition.type_name)};".encode()),
        history,
        _reliability(profile.reliability, writer),
        Policy.Deadline(profile.deadline.nanoseconds or FOREVER),
        _liveliness(profile),
    ]
    if profile.durability == DurabilityPolicy.TRANSIENT_LOCAL or (
        writer and profile.durability == DurabilityPolicy.BEST_AVAILABLE
    ):
        policies += [
            Policy.Durability.TransientLocal,
            Policy.DurabilityService(0, history, UNLIMITED, UNLIMITED, UNLIMITED),
        ]
    else:
        policies.append(Policy.Durability.Volatile)
    if writer:
        policies += [
            Policy.Lifespan(profile.lifespan.nanoseconds or FOREVER),
            Policy.WriterDataLifecycle(autodispose=False),
        ]
    return Qos(*policies)


def from_dds(qos: Qos) -> QoSProfile:
    """Return the profile of an endpoint as it was discovered."""
    history = qos[Policy.History]
    reliable = isinstance(qos[Policy.Reliability], Policy.Reliability.Reliable)
    liveliness = qos[Policy.Liveliness]
    return QoSProfile(
        history=HistoryPolicy.KEEP_ALL if history == Policy.History.KeepAll else HistoryPolicy.KEEP_LAST,
        depth=history.depth if isinstance(history, Policy.History.KeepLast) else 0,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE
        if qos[Policy.Durability] == Policy.Durability.Volatile
        else DurabilityPolicy.TRANSIENT_LOCAL,
        lifespan=Duration(nanoseconds=qos[Policy.Lifespan].lifespan if Policy.Lifespan in qos else FOREVER),
        deadline=Duration(nanoseconds=qos[Policy.Deadline].deadline if Policy.Deadline in qos else FOREVER),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC
        if isinstance(liveliness, Policy.Liveliness.ManualByTopic)
        else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=Duration(nanoseconds=liveliness.lease_duration if liveliness else FOREVER),
    )


def _reliability(reliability: ReliabilityPolicy, writer: bool) -> object:
    best_effort = (
        {ReliabilityPolicy.BEST_EFFORT} if writer else {ReliabilityPolicy.BEST_EFFORT, ReliabilityPolicy.BEST_AVAILABLE}
    )
    return Policy.Reliability.BestEffort if reliability in best_effort else Policy.Reliability.Reliable(FOREVER)


def _liveliness(profile: QoSProfile) -> object:
    manual = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    kind = Policy.Liveliness.ManualByTopic if manual else Policy.Liveliness.Automatic
    return kind(profile.liveliness_lease_duration.nanoseconds or FOREVER)
