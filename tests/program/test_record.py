"""The record of a run: counts by topic and direction, and the outcome of messages."""

from collections import Counter
from types import SimpleNamespace

import pytest
from sensor_msgs.msg import JointState

from tutorial.joints import JointReport
from tutorial.program.record import make_record

STATE = JointState(name=["TURRET_Y"], position=[0.5])


def meter(topic, direction, count, last=STATE):
    """Return a node's meter with a number of counted messages."""
    latency = {"median": 2.0, "p99": 2.5} if direction == "received" else {"median": None, "p99": None}
    kind = {"type_name": "a/msg/B", "rate": 10.0, "latency_ms": lambda: latency}
    return SimpleNamespace(topic=topic, direction=direction, count=count, last=last, **kind)


def shown(*topics, messages=0, **positions):
    """Return an item that has displayed a number of messages."""
    joints = [SimpleNamespace(name=name, position=position) for name, position in positions.items()]
    watch = SimpleNamespace(
        applied=messages, tally=Counter(matched=messages), meters=[meter(each, "received", messages) for each in topics]
    )
    return SimpleNamespace(body=SimpleNamespace(joints=joints), joints=watch)


def test_a_process_without_a_display_has_a_record():
    record = make_record("joy", 2.0, [meter("/joy", "published", 3, last=None)])
    assert (record["node"], record["seconds"], record["joints"]) == ("joy", 2.0, {})
    assert set(record["report"]) == set(JointReport().counts())
    assert {"another", "late", "unknown", "duplicate", "short", "long", "non_finite", "huge"} < set(record["report"])
    assert not any(record["report"].values())
    assert record["topics"]["/joy"]["published"] == 3


@pytest.mark.parametrize("order", [1, -1])
def test_a_topic_in_both_directions_has_both_counts_and_its_latency(order):
    meters = [meter("/a", "published", 4), meter("/a", "received", 3), meter("/a", "published", 2)][::order]
    (record,) = make_record("echo", 1.0, meters)["topics"].values()
    assert (record["published"], record["received"]) == (6, 3)
    assert record["latency_ms"] == {"median": 2.0, "p99": 2.5}
    assert make_record("two", 1.0, meters[::2])["topics"]["/a"]["rate_hz"] == 20.0


def test_applied_counts_belong_to_received_topics():
    meters = [meter("/A/joint_state", "published", 9), meter("/B/joint_state", "received", 5)]
    items = [shown("/A/joint_state"), shown("/B/joint_state", messages=2), shown("/B/joint_state", messages=3)]
    record = make_record("viewer", 1.0, meters, items)
    assert "applied" not in record["topics"]["/A/joint_state"]
    assert record["topics"]["/B/joint_state"]["applied"] == 5
    assert record["report"]["matched"] == 5


@pytest.mark.parametrize(("ends", "turret"), [([], 0.1), (["received"], 0.1), (["published"], 0.5)])
def test_a_joints_position_is_the_published_one_or_the_displayed_one(ends, turret):
    meters = [meter("/Tank/joint_state", end, 1) for end in ends]
    record = make_record("tank", 1.0, meters, [shown(TURRET_Y=0.1, TURRET_P=0.2)])
    assert record["joints"] == {"TURRET_Y": turret, "TURRET_P": 0.2}
