"""Make a QoS profile's policies explicit."""

from rclpy.duration import Duration, Infinite
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy


def explicit(profile: QoSProfile, *, writer: bool) -> QoSProfile:
    """Return the policies of a writer or reader, with the system defaults replaced by explicit values.

    Args:
        profile: the requested QoS; "best available" means the strongest policy for a writer and the weakest
            for a reader.
        writer: whether the policies are for a writer.

    Raises:
        TypeError: the depth is negative.
    """
    if profile.depth < 0:
        raise TypeError(f"QoSProfile: depth is {profile.depth}, but must not be negative")
    keep_all = profile.history == HistoryPolicy.KEEP_ALL
    best_effort = profile.reliability.name in (["BEST_EFFORT"] if writer else ["BEST_EFFORT", "BEST_AVAILABLE"])
    kept = profile.durability.name in (["TRANSIENT_LOCAL", "BEST_AVAILABLE"] if writer else ["TRANSIENT_LOCAL"])
    manual = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    return QoSProfile(
        history=HistoryPolicy.KEEP_ALL if keep_all else HistoryPolicy.KEEP_LAST,
        depth=0 if keep_all else profile.depth or 1,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if kept else DurabilityPolicy.VOLATILE,
        lifespan=_span(profile.lifespan) if writer else Infinite,
        deadline=_span(profile.deadline),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC if manual else LivelinessPolicy.AUTOMATIC,
        liveliness_lease_duration=_span(profile.liveliness_lease_duration),
    )


def _span(duration: Duration) -> Duration:
    """Return a duration as sent on the wire; 0 and "best available" mean no limit."""
    return duration if 0 < duration.nanoseconds < Infinite.nanoseconds - 1 else Infinite
