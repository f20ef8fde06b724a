"""The laws of joint matching."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from random import Random

import pytest
from hypothesis import given, settings
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


def test_large_numbers_without_a_range_are_all_shown():
    values, report = match_joints(["a", "b"], joint_state(["a", "b"], [1e9, -1e9]))
    assert values == {"a": 1e9, "b": -1e9}
    assert report.clean


@pytest.mark.parametrize("far", [1.1e9, -1e38, 1e300])
def test_what_single_precision_cannot_show_is_left_out_and_the_others_apply(far):
    values, report = match_joints(["a", "b"], joint_state(["a", "b"], [far, 0.2]))
    assert values == {"b": 0.2}
    assert report.counts()["huge"] == 1
    assert str(report) == "1 joint shown; too far to be shown: 'a'"


def test_more_positions_than_names_are_reported():
    values, report = match_joints(TANK, joint_state(["TURRET_Y"], [0.1, 0.2, 0.3]))
    assert values == {"TURRET_Y": 0.1}
    assert report.counts()["long"] == 2
    assert str(report) == "1 joint shown; more positions than names, by 2"


def test_of_very_many_names_only_the_first_are_looked_up():
    message = joint_state(["X"] * 20_000 + ["TURRET_Y"], [0.1] * 20_001)
    values, report = match_joints(TANK, message)
    assert values == {}
    assert report.unknown.total == 20_001


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


@dataclass
class Publisher:
    """A simulated publisher: its joints swing about a middle, and its clock runs from a start."""

    name: str
    begin: float  # [s] when it publishes first
    end: float
    clock: float  # [s] its first stamp
    rate: float  # [Hz]
    middle: float  # [rad]

    def messages(self, random, jitter):
        """(when it arrives [s], the name, the message), in order: DDS keeps the order of each publisher's messages."""
        arrival = 0.0
        for i in range(round((self.end - self.begin) * self.rate)):
            age = i / self.rate
            arrival = max(arrival, self.begin + age + random.uniform(0, jitter))
            angle = self.middle + 0.3 * math.sin(age)
            message = joint_state(["TURRET_Y", "TURRET_P"], [angle, 0.1], round((self.clock + age) * 1e9))
            yield arrival, self.name, message


def follow(publishers, random, jitter):
    """What one matcher makes of them all: (when, whose message, its report)."""
    now = 0.0
    matcher = JointMatcher(TANK, lambda: sum(each.begin <= now < each.end + jitter for each in publishers))
    found = []
    for now, name, message in arrivals(publishers, random, jitter):
        found.append((now, name, matcher.match(message)[1]))
    return found


def arrivals(publishers, random, jitter):
    messages = [message for publisher in publishers for message in publisher.messages(random, jitter)]
    return sorted(messages, key=lambda message: message[0])


def turns(found):
    """Whose messages were shown, each time it was another's: (since when, whose)."""
    shown = [(when, name) for when, name, report in found if report.joints]
    return [each for before, each in pairwise([(0.0, ""), *shown]) if before[1] != each[1]]


RATES = st.sampled_from([10.0, 20.0, 50.0, 100.0])
OFFSETS = st.sampled_from([0.0, 0.003, 0.02, 0.03, 0.3, 0.99, 5.0, 500.0, 1.7e9])


class TestTwoPublishers:
    @settings(max_examples=60, deadline=None)
    @given(OFFSETS, st.booleans(), RATES, RATES, st.sampled_from([0.0, 0.005, 0.03]), st.integers(0, 999))
    def test_one_is_followed_until_it_is_silent(self, offset, is_ahead, rate, other_rate, jitter, seed):
        start, other_start = (10.0, 13.0 + offset) if is_ahead else (10.0 + offset, 13.0)
        one = Publisher("one", 0.0, 10.0, start, rate, 1.0)
        other = Publisher("other", 3.0, 14.0, other_start, other_rate, -1.0)
        found = follow([one, other], Random(seed), jitter)
        settled = [turn for turn in turns(found) if turn[0] > 4.5]
        assert len(settled) <= 1  # one of them, whichever; and the other one when it has gone
        assert all(when > 9.5 and name == "other" for when, name in settled)
        last = found[-1]
        assert last[2].joints
        assert sum(report.another for _, _, report in found) > 50

    def test_the_one_that_was_there_before_is_followed_where_the_stamps_tell_them_apart(self):
        one, other = Publisher("one", 0, 9, 100, 50, 1.0), Publisher("other", 3, 12, 0, 50, -1.0)
        found = follow([one, other], Random(0), 0.005)
        assert [name for _, name in turns(found)] == ["one", "other"]
        reports = [str(report) for _, _, report in found]
        assert (
            reports.count("2 joints shown; the publisher was started again, or fell silent and another one is followed")
            <= 1
        )
        assert "a message of another publisher was dropped" in reports
        assert not any(report.late or report.restarted for when, _, report in found if when < 9)

    def test_one_that_stalls_while_both_go_on_is_not_followed_any_more(self):
        one, other = Publisher("one", 0, 9, 100, 50, 1.0), Publisher("other", 3, 12, 0, 50, -1.0)
        matcher = JointMatcher(TANK, lambda: 2)
        found = [
            (when, name, matcher.match(message)[1])
            for when, name, message in arrivals([one, other], Random(0), 0.0)
            if not (name == "one" and 5.0 < when < 6.0)
        ]
        assert [name for _, name in turns(found)] == ["one", "other"]
        assert [round(when, 1) for when, _, report in found if report.switched] == [5.5]

    def test_one_alone_is_believed_whatever_its_joints_do(self):
        matcher = JointMatcher(TANK, lambda: 1)
        for i, position in enumerate([0.5, -0.5] * 20):
            assert matcher.match(joint_state(["TURRET_Y"], [position], i * 20_000_000))[0] == {"TURRET_Y": position}

    def test_one_alone_that_was_started_again_is_shown_at_once_whoever_else_there_was(self):
        before, again = Publisher("one", 0, 4, 100, 50, 1.0), Publisher("again", 5, 7, 0, 50, -1.0)
        other = Publisher("other", 2, 4, 50, 50, 0.0)
        found = follow([before, other, again], Random(0), 0.0)
        first = next(report for _, name, report in found if name == "again")
        assert str(first).startswith("2 joints shown; the publisher was started again")

    def test_when_the_followed_one_has_gone_the_other_is_shown_at_once_and_it_is_said(self):
        one, other = Publisher("one", 0, 4, 100, 50, 1.0), Publisher("other", 2, 6, 0, 50, -1.0)
        found = follow([one, other], Random(0), 0.0)
        ((when, name, report),) = [each for each in found if each[2].switched]
        assert (when, name) == (pytest.approx(4.0), "other")
        assert str(report).endswith("the publisher was started again, or fell silent and another one is followed")

    def test_beside_a_silent_one_a_new_start_is_taken_within_half_a_second(self):
        matcher, count = JointMatcher(TANK, lambda: 2), 0
        matcher.match(joint_state(["TURRET_Y"], [1.0], 50_000_000_000))
        while not matcher.match(joint_state(["TURRET_Y"], [0.0], count * 20_000_000))[0]:
            count += 1
        assert count < 25

    def test_those_with_other_joints_are_both_shown(self):
        matcher = JointMatcher(TANK, lambda: 2)
        for i in range(50):
            joint = ("TURRET_Y", "TURRET_P")[i % 2]
            assert matcher.match(joint_state([joint], [0.7 * (i % 2)], i * 10_000_000))[0] == {joint: 0.7 * (i % 2)}

    def test_joints_without_limits_may_turn_as_fast_as_they_like(self):
        matcher = JointMatcher(["WHEEL"], lambda: 2)
        for i in range(50):
            assert matcher.match(joint_state(["WHEEL"], [3.0 * (-1) ** i], i * 20_000_000))[0]


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
    assert report == JointReport(("TURRET_Y", "TURRET_P"))
    assert report.matched == 2
    assert all(isinstance(value, (int, bool, tuple)) for value in report)
