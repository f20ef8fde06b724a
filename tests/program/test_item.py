"""A body with its controllers: the reports of the messages that have moved it."""

import math
from pathlib import Path
from types import SimpleNamespace

import pytest
from sensor_msgs.msg import JointState

from tutorial.joints import JointMatcher
from tutorial.program import item as item_module
from tutorial.program.item import Item
from tutorial.ros.node_thread import TopicMeter
from tutorial.world import Placement

TANK = Placement("Tank", Path(__file__).parents[2] / "project" / "models" / "tank.xml")
RANGES = {"TURRET_Y": (-6.3, 6.3), "TURRET_P": (-0.2, 0.8)}  # [rad]


@pytest.fixture
def nodes():
    """The publishers on every topic."""
    return []


@pytest.fixture
def item(nodes):
    return Item(TANK, SimpleNamespace(get_publishers_info_by_topic=lambda _: nodes), None, None)


@pytest.fixture
def joints(item):
    return item.joints


def show(joints, matcher, name, position, nanoseconds):
    message = JointState(name=name, position=position)
    message.header.stamp.nanosec = nanoseconds
    joints.take(matcher.match(message)[1])


def test_reports_are_counted_without_keeping_strange_names(joints, clock):
    matcher = JointMatcher(RANGES)
    show(joints, matcher, ["TURRET_Y", "TURRET_P"], [0.1, 0.2], 50)
    show(joints, matcher, ["TURRET_Y", "X"], [math.nan, 0.2], 60)
    show(joints, matcher, ["TURRET_P", "TURRET_P", "TURRET_Y"], [0.1, 0.2], 70)
    show(joints, matcher, ["TURRET_Y"], [0.1], 40)
    assert joints.applied == 3
    found = {"matched": 3, "unknown": 1, "non_finite": 1, "short": 1, "duplicate": 1, "late": 1}
    assert {kind: count for kind, count in joints.tally.items() if count} == found
    assert joints.line().startswith("Tank: a late message was dropped (0.")
    clock.now += 5.0
    assert set(joints.stale()) == set(RANGES)


def test_a_change_without_a_report_is_drawn_but_not_counted(item):
    assert (item.take_dirty(), item.take_dirty()) == (True, False)
    item.body.notify_change()
    assert item.take_dirty()
    assert (item.joints.applied, item.joints.line()) == (0, "")


def test_before_the_first_message_the_line_says_so(joints):
    assert joints.line() == "", "without a subscription"
    joints.meters = [TopicMeter(JointState, "/Tank/joint_state", "received")]
    assert joints.line() == "Tank: no message on /Tank/joint_state yet"
    joints.meters[0].count = 1
    assert joints.line() == "Tank: no message on /Tank/joint_state could be shown yet"


@pytest.fixture
def clock(monkeypatch):
    """A fake of the module `time`."""
    clock = SimpleNamespace(now=100.0, monotonic=lambda: clock.now)
    monkeypatch.setattr(item_module, "time", clock)
    return clock


def test_a_joint_is_stale_from_a_seconds_silence_to_its_next_message(joints, clock):
    matcher = JointMatcher(RANGES)
    assert joints.stale() == {}, "before any message"
    show(joints, matcher, ["TURRET_Y"], [0.1], 10)
    assert joints.stale() == {}
    clock.now = 103.4
    show(joints, matcher, ["TURRET_Y"], [0.1], 20)
    assert joints.stale() == {"TURRET_P": 3}
    assert joints.line() == "Tank: 1 joint shown; TURRET_P: nothing for 3 s (0.0 s ago)"
    show(joints, matcher, ["TURRET_P"], [0.1], 30)
    assert joints.stale() == {}
    show(joints, matcher, ["TURRET_P"], [math.nan], 40)
    clock.now = 105.0
    said = "0 joints shown; not a finite number: 'TURRET_P'; TURRET_Y: nothing for 1 s, TURRET_P: nothing for 1 s"
    assert joints.line() == f"Tank: {said} (1.6 s ago)"


def test_problems_are_one_throttled_line(joints, clock, caplog):
    matcher = JointMatcher(RANGES)
    for i in range(14):
        clock.now = 100.0 + 0.5 * i
        show(joints, matcher, ["TURET_Y", "TURRET_P"], [0.1, 0.2], i)
        assert joints.tally["matched"] == i + 1, "even the same report is counted each time"
    said = "Tank: 1 joint shown; unknown 'TURET_Y'. Did you mean 'TURRET_Y'? Known: 'TURRET_P', 'TURRET_Y'."
    assert caplog.messages == [said, said]


def test_one_shared_joint(joints, nodes, clock, caplog):
    matcher = JointMatcher(RANGES, lambda: 2)
    nodes += [SimpleNamespace(node_namespace="/", node_name=name) for name in ("arm", "all")]
    joints.meters = [TopicMeter(JointState, "/Tank/joint_state", "received")]
    show(joints, matcher, ["TURRET_Y"], [1.0], 10)
    show(joints, matcher, ["TURRET_Y", "TURRET_P"], [0.0, 0.2], 20)
    assert joints.applied == 2
    said = "1 joint shown; a message from another publisher was dropped for 'TURRET_Y'"
    named = "2 nodes publish on /Tank/joint_state; only one of these is followed: /all, /arm"
    assert joints.line() == f"Tank: {said}; {named} (0.0 s ago)"
    assert caplog.messages == [f"Tank: {named}", f"Tank: {said}"]


def test_a_second_publisher_is_reported_by_name(joints, nodes, clock, caplog):
    matcher = JointMatcher(RANGES, lambda: 2)
    named = (("", "simulation"), ("lab", "\x1b[2Jforged"))
    nodes += [SimpleNamespace(node_namespace=f"/{space}", node_name=name) for space, name in named]
    joints.meters = [TopicMeter(JointState, "/Tank/joint_state", "received")]
    for i in range(20):
        show(joints, matcher, ["TURRET_Y", "TURRET_P"], [0.1, 0.2], 20_000_000 * i)
        show(joints, matcher, ["TURRET_Y", "TURRET_P"], [-1.0, 0.2], 20_000_000 * i + 1000)
        clock.now += 0.5
        said = "2 nodes publish on /Tank/joint_state; only one of these is followed: /lab/\\x1b[2Jforged, /simulation"
        assert joints.line() == f"Tank: 2 joints shown; {said} (0.5 s ago)"
    assert caplog.messages == [f"Tank: {said}"]
    assert (joints.applied, joints.tally["another"]) == (20, 20)
    del nodes[1:]
    clock.now += 5.0
    assert "publish" not in joints.line()


LINKED = """
<mujoco><worldbody>
  <body name="PALM"><joint name="A"/><geom size="0.1"/></body>
  <body><joint name="B"/><geom size="0.1"/></body>
  <body><joint name="C"/><geom size="0.1"/></body>
</worldbody><equality><joint joint1="B" joint2="A"/>EQUALITY</equality></mujoco>
"""


@pytest.mark.parametrize(
    ("equality", "said"),
    [
        ("", []),
        ('<joint joint1="C" joint2="B"/>', []),
        (
            '<connect body1="PALM" anchor="0 0 0"/>',
            [
                "Hand: its model couples links with <connect>, which the view does not compute. "
                "Joints that are not named in any message keep their positions: 'C'"
            ],
        ),
    ],
)
def test_followers_are_not_stale(tmp_path, clock, caplog, nodes, equality, said):
    path = tmp_path / "hand.xml"
    path.write_text(LINKED.replace("EQUALITY", equality))
    hand = Item(Placement("Hand", path), SimpleNamespace(get_publishers_info_by_topic=lambda _: nodes), None, None)
    positions, report = JointMatcher(hand.body.joint_ranges).match(JointState(name=["A"], position=[0.5]))
    hand.body.set_joint_positions(positions)
    hand.body.notify_change(report)
    clock.now += 5.0
    assert "B" not in hand.joints.stale()
    assert set(hand.joints.stale()) == ({"A"} if "C" in hand.body.followers else {"A", "C"})
    assert caplog.messages == said
