"""The laws of joint matching."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import JointState

from tutorial.joints import JointMatcher, JointReport, match_joints

TANK = {"TURRET_Y": (-6.28, 6.28), "TURRET_P": (-0.17, 0.79)}

names = st.sampled_from(["TURRET_Y", "TURRET_P", "TURET_Y", "", "砲塔"])
angles = st.floats(-0.1, 0.1)
pairs = st.dictionaries(names, angles)


def joint_state(name, position, nanoseconds=0):
    message = JointState(name=list(name), position=list(position))
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
    return message


def applied(pose, *messages):
    """The pose after some messages of one stamp."""
    pose = dict(pose)
    for message in messages:
        pose.update(match_joints(TANK, message)[0])
    return pose


@given(pairs, st.randoms())
def test_permuting_the_pairs_changes_nothing(state, random):
    shuffled = list(state.items())
    random.shuffle(shuffled)
    one = match_joints(TANK, joint_state(state.keys(), state.values()))
    other = match_joints(TANK, joint_state(*zip(*shuffled, strict=True)) if shuffled else joint_state([], []))
    assert one[0] == other[0]
    assert one[1].matched == other[1].matched


@given(pairs, st.integers(0, 5))
def test_a_message_in_two_parts_equals_the_whole(state, cut):
    items = list(state.items())
    parts = [joint_state([n for n, _ in part], [v for _, v in part]) for part in (items[:cut], items[cut:])]
    whole = joint_state(state.keys(), state.values())
    pose = {"TURRET_Y": 1.0, "TURRET_P": 0.5}
    assert applied(pose, *parts) == applied(pose, whole)


@given(st.lists(names, max_size=6), st.lists(st.floats(allow_nan=True, allow_infinity=True), max_size=6))
def test_whatever_comes_in_only_known_joints_move_and_only_to_received_finite_values(name, position):
    values, report = match_joints(TANK, joint_state(name, position))
    assert set(values) <= set(TANK)
    for joint, value in values.items():
        assert math.isfinite(value)
        assert (joint, value) in set(zip(name, position, strict=False))
    assert report.matched == len(values)
    assert report.clean is (str(report).count(";") == 0)


@given(st.lists(st.text(max_size=200), max_size=300), st.lists(st.floats(), max_size=300))
def test_a_report_is_small_whatever_comes_in(name, position):
    _, report = match_joints(TANK, joint_state(name, position))
    assert len(str(report)) < 2000


def test_the_usual_message():
    values, report = match_joints(TANK, joint_state(["TURRET_Y", "TURRET_P"], [0.5, -0.01]))
    assert values == {"TURRET_Y": 0.5, "TURRET_P": -0.01}
    assert report.clean
    assert str(report) == "2 joints shown"


def test_names_alone_will_do_for_the_joints():
    assert match_joints(["a", "b"], joint_state(["b"], [1.0]))[0] == {"b": 1.0}


def test_an_unknown_name_is_reported_with_the_nearest():
    values, report = match_joints(TANK, joint_state(["TURET_Y", "TURRET_P"], [0.1, 0.2]))
    assert values == {"TURRET_P": 0.2}
    assert report.unknown.total == 1
    assert "unknown 'TURET_Y'. Did you mean 'TURRET_Y'?" in str(report)


def test_of_twins_the_last_wins():
    values, report = match_joints(TANK, joint_state(["TURRET_Y", "TURRET_Y"], [0.1, 0.2]))
    assert values == {"TURRET_Y": 0.2}
    assert report.duplicate.names == ("TURRET_Y",)
    assert "named twice, the last wins: 'TURRET_Y'" in str(report)


def test_of_a_short_array_the_prefix_is_used():
    values, report = match_joints(TANK, joint_state(["TURRET_Y", "TURRET_P"], [0.1]))
    assert values == {"TURRET_Y": 0.1}
    assert report.short == 1
    assert "no position for the last name" in str(report)


def test_no_positions_at_all_leave_the_pose():
    values, report = match_joints(TANK, joint_state(["TURRET_Y", "TURRET_P"], []))
    assert values == {}
    assert report.short == 0
    assert report.clean


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_no_finite_number_is_left_out_and_the_others_apply(bad):
    values, report = match_joints(TANK, joint_state(["TURRET_Y", "TURRET_P"], [bad, 0.2]))
    assert values == {"TURRET_P": 0.2}
    assert report.non_finite.names == ("TURRET_Y",)
    assert "not a finite number: 'TURRET_Y'" in str(report)


def test_finite_numbers_whose_sum_is_not_are_all_shown():
    values, report = match_joints(["a", "b"], joint_state(["a", "b"], [1.7e308, 1.7e308]))
    assert values == {"a": 1.7e308, "b": 1.7e308}
    assert report.clean


def test_outside_its_range_a_joint_is_shown_as_received_and_reported():
    values, report = match_joints(TANK, joint_state(["TURRET_P"], [1.5]))
    assert values == {"TURRET_P": 1.5}
    assert "outside its range: 'TURRET_P'" in str(report)


class TestTime:
    def follow(self, *stamps_ms):
        """What becomes of messages with these stamps: the stamp if it was shown, else None."""
        matcher, shown = JointMatcher(TANK), []
        for stamp in stamps_ms:
            values, report = matcher.match(joint_state(["TURRET_Y"], [0.1], stamp * 1_000_000))
            shown.append(stamp if values else None)
        return shown, report

    def test_a_stamp_that_steps_back_a_little_is_late_and_dropped(self):
        shown, report = self.follow(100, 140, 120, 160)
        assert shown == [100, 140, None, 160]
        assert not report.late

    def test_late_messages_do_not_move_the_clock_back(self):
        shown, _ = self.follow(1900, 1000, 950)
        assert shown == [1900, None, None]

    def test_far_back_means_that_the_publisher_was_started_again(self):
        shown, report = self.follow(5000, 20)
        assert shown == [5000, 20]
        assert "the publisher was started again" in str(report)

    def test_stamp_zero_begins_anew(self):
        shown, _ = self.follow(500, 0, 20)
        assert shown == [500, 0, 20]

    def test_equal_stamps_are_all_shown(self):
        shown, report = self.follow(0, 0, 20, 20)
        assert shown == [0, 0, 20, 20]
        assert report.clean

    def test_a_late_message_is_said(self):
        _, report = self.follow(100, 50)
        assert report.late
        assert str(report) == "a late message was dropped"

    def test_a_stamp_before_1970_is_no_restart_when_it_is_the_first(self):
        assert self.follow(-5)[1].clean


messages = st.builds(
    joint_state,
    st.lists(names, max_size=6),
    st.lists(st.floats(), max_size=6),
)


@given(st.lists(messages, max_size=5))
def test_one_matcher_makes_of_every_message_what_a_fresh_one_would(stream):
    matcher = JointMatcher(TANK)
    for message in stream:
        values, report = matcher.match(message)
        fresh = match_joints(TANK, message)
        assert (values, report) == fresh
        assert str(report) == str(fresh[1])


def test_a_matcher_keeps_to_the_joints_that_it_was_made_for():
    joints = {"a": (-1.0, 1.0)}
    matcher = JointMatcher(joints)
    message = joint_state(["a", "b"], [2.0, 3.0])
    before = matcher.match(message)
    joints.update(a=(-9.0, 9.0), b=(-9.0, 9.0))
    assert matcher.match(message) == before
    assert before[1].unknown.names == ("b",)
    values, report = match_joints(joints, message)
    assert (values, report.clean) == ({"a": 2.0, "b": 3.0}, True)


def test_a_report_is_plain_values_and_its_repr_short():
    _, report = match_joints(TANK, joint_state(["TURRET_Y", "TURRET_P"], [0.5, -0.01]))
    assert repr(report) == "JointReport('2 joints shown')"
    assert report == JointReport(matched=2)
    assert all(isinstance(value, (int, bool, tuple)) for value in report)
