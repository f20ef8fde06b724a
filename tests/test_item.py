"""A body with its controllers: what is known of the messages that have moved it."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from sensor_msgs.msg import JointState

from tutorial.body import Body
from tutorial.item import Item
from tutorial.joints import JointMatcher
from tutorial.world import Placement

TANK = Placement("Tank", Path(__file__).parent.parent / "project" / "models" / "tank.xml")


@pytest.fixture
def item():
    return Item(Body.displayed(TANK))


def show(item, matcher, name, position, nanoseconds):
    message = JointState(name=name, position=position)
    message.header.stamp.nanosec = nanoseconds
    item.body.notify_change(matcher.match(message)[1])


def test_the_reports_of_its_messages_are_summed_up(item):
    matcher = JointMatcher(item.body.joint_ranges)
    show(item, matcher, ["TURRET_Y", "TURRET_P"], [0.1, 0.2], 50)
    show(item, matcher, ["TURRET_Y", "X"], [math.nan, 0.2], 60)
    show(item, matcher, ["TURRET_P", "TURRET_P", "TURRET_Y"], [0.1, 0.2], 70)
    show(item, matcher, ["TURRET_Y"], [0.1], 40)
    assert item.applied == 3
    assert item.tally == {"matched": 3, "unknown": 1, "non_finite": 1, "short": 1, "duplicate": 1, "late": 1}
    assert item.line().startswith("Tank: a late message was dropped (0.")


@pytest.mark.parametrize("report", [None, "mine", {"TURRET_Y": 0.1}])
def test_a_change_with_a_report_of_another_kind_is_drawn_and_not_counted(item, report):
    assert item.take_dirty()
    assert not item.take_dirty()
    item.body.notify_change(report)
    assert item.take_dirty()
    assert (item.applied, item.line()) == (0, "")
