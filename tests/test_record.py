"""The record of a run: what is counted, by topic and direction, and what became of the messages."""

from __future__ import annotations

from collections import Counter
from types import SimpleNamespace

import pytest
from sensor_msgs.msg import JointState

from tutorial.joints import JointReport
from tutorial.record import make_record

STATE = JointState(name=["TURRET_Y"], position=[0.5])


def meter(topic, direction, count, last=STATE):
    """What a node has counted about so many messages."""
    latency = {"median": 2.0, "p99": 2.5} if direction == "received" else {"median": None, "p99": None}
    return SimpleNamespace(
        topic=topic,
        direction=direction,
        type_name="a/msg/B",
        count=count,
        last=last,
        rate=10.0,
        latency_ms=lambda: latency,
    )


def shown(*topics, messages=0, **positions):
    """An item that has displayed so many messages."""
    joints = [SimpleNamespace(name=name, position=position) for name, position in positions.items()]
    tally = Counter(matched=messages)
    return SimpleNamespace(body=SimpleNamespace(joints=joints), applied=messages, tally=tally, joint_topics=topics)


def test_a_process_that_displays_nothing_has_a_record_too():
    record = make_record("joy", 2.0, [meter("/joy", "published", 3, last=None)])
    assert (record["node"], record["seconds"], record["joints"]) == ("joy", 2.0, {})
    assert set(record["report"]) == set(JointReport().counts())
    assert {"another", "late", "unknown", "duplicate", "short", "long", "non_finite", "huge"} < set(record["report"])
    assert not any(record["report"].values())
    assert record["topics"]["/joy"]["published"] == 3


@pytest.mark.parametrize("order", [1, -1])
def test_a_topic_that_goes_both_ways_has_both_counts_and_the_latency_of_receiving(order):
    meters = [meter("/a", "published", 4), meter("/a", "received", 3)][::order]
    (record,) = make_record("echo", 1.0, meters)["topics"].values()
    assert (record["published"], record["received"]) == (4, 3)
    assert record["latency_ms"] == {"median": 2.0, "p99": 2.5}


def test_of_two_publishers_of_one_topic_none_is_lost():
    meters = [meter("/a", "published", 4), meter("/a", "published", 2)]
    record = make_record("two", 1.0, meters)["topics"]["/a"]
    assert record["published"] == 6
    assert record["rate_hz"] == 20.0


def test_applied_belongs_to_what_is_received():
    meters = [meter("/A/joint_state", "published", 9), meter("/B/joint_state", "received", 5)]
    items = [shown("/A/joint_state"), shown("/B/joint_state", messages=2), shown("/B/joint_state", messages=3)]
    record = make_record("viewer", 1.0, meters, items)
    assert "applied" not in record["topics"]["/A/joint_state"]
    assert record["topics"]["/B/joint_state"]["applied"] == 5
    assert record["report"]["matched"] == 5


def test_a_joint_is_where_it_was_published_last_else_where_it_is_displayed():
    items = [shown(TURRET_Y=0.1, TURRET_P=0.2)]
    assert make_record("tank", 1.0, [], items)["joints"] == {"TURRET_Y": 0.1, "TURRET_P": 0.2}
    received = [meter("/Tank/joint_state", "received", 1)]
    assert make_record("tank", 1.0, received, items)["joints"] == {"TURRET_Y": 0.1, "TURRET_P": 0.2}
    published = [meter("/Tank/joint_state", "published", 1)]
    assert make_record("tank", 1.0, published, items)["joints"] == {"TURRET_Y": 0.5, "TURRET_P": 0.2}
