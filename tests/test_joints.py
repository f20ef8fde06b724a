"""Joints are matched by name. Properties state the laws, and a table lists cases."""

import math
from dataclasses import dataclass
from itertools import pairwise
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sensor_msgs.msg import JointState

from tutorial.joints import Arrival, JointMatcher, JointReport, match_joints

TANK = {"TURRET_Y": (-6.28, 6.28), "TURRET_P": (-0.17, 0.79)}

names = st.sampled_from(["TURRET_Y", "TURRET_P", "TURET_Y", "", "砲塔"])
pairs = st.dictionaries(names, st.floats(-0.1, 0.1))


def joint_state(name, position, nanoseconds=0):
    message = JointState(name=list(name), position=list(position))
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
    return message


@given(pairs, st.randoms())
def test_permuting_the_pairs_changes_nothing(state, random):
    shuffled = random.sample(list(state.items()), len(state))
    one = match_joints(TANK, joint_state(state, state.values()))
    other = match_joints(TANK, joint_state(dict(shuffled), dict(shuffled).values()))
    assert one[0] == other[0]
    assert len(one[1].joints) == len(other[1].joints)


@given(pairs, st.integers(0, 5))
def test_a_split_message_equals_the_whole(state, cut):
    def pose(*parts):
        pose = {"TURRET_Y": 1.0, "TURRET_P": 0.5}
        for part in parts:
            pose.update(match_joints(TANK, joint_state(dict(part), dict(part).values()))[0])
        return pose

    items = list(state.items())
    assert pose(items[:cut], items[cut:]) == pose(items)


messages = st.builds(joint_state, st.lists(names, max_size=6), st.lists(st.floats(), max_size=6))


@given(st.lists(messages, max_size=5))
def test_only_known_joints_move_and_only_to_received_finite_values(stream):
    matcher = JointMatcher(TANK)
    for message in stream:
        values, report = matcher.match(message)
        assert set(values) <= set(TANK)
        assert set(values.items()) <= set(zip(message.name, message.position))
        assert all(map(math.isfinite, values.values()))
        assert len(report.joints) == len(values)
        assert report.clean is (str(report).count(";") == 0)
        fresh = match_joints(TANK, message)
        assert (values, report, str(report)) == (*fresh, str(fresh[1])), "the matcher behaves like a new one"


TWICE = "named twice (the last number is used): 'a'"
KNOWN = "Known: 'TURRET_P', 'TURRET_Y'."


@pytest.mark.parametrize(
    ("joints", "name", "position", "values", "said"),
    [
        (TANK, ["TURRET_P", "TURRET_Y"], [0.2, 0.1], {"TURRET_Y": 0.1, "TURRET_P": 0.2}, "2 joints shown"),
        ("ab", ["a", "b"], [1e9, -1e9], {"a": 1e9, "b": -1e9}, "2 joints shown"),
        ("ab", ["a", "b"], [-1.1e9, 0.2], {"b": 0.2}, "1 joint shown; too large to show: 'a'"),
        (TANK, [*TANK], [math.nan, 0.2], {"TURRET_P": 0.2}, "1 joint shown; not a finite number: 'TURRET_Y'"),
        (TANK, [*TANK], [], {}, "0 joints shown"),
        (TANK, ["TURRET_Y"] * 2, [0.1], {"TURRET_Y": 0.1}, "1 joint shown; no position for the last name"),
        (TANK, ["TURRET_Y"] * 3, [0.1], {"TURRET_Y": 0.1}, "1 joint shown; no position for the last 2 names"),
        (TANK, ["TURRET_Y"], [0.1] * 3, {"TURRET_Y": 0.1}, "1 joint shown; positions without a name: 2"),
        (TANK, ["TURRET_P"], [0.7909], {"TURRET_P": 0.7909}, "1 joint shown"),
        (TANK, ["TURRET_P"], [1.5], {"TURRET_P": 1.5}, "1 joint shown; outside its range: 'TURRET_P'"),
        *(
            ("ab", ["a", "b", "a"], [*twins[:1], 0.3, *twins[1:]], {"a": 0.2, "b": 0.3}, f"2 joints shown; {TWICE}")
            for twins in ((0.1, 0.2), (math.nan, 0.2), (0.2, math.nan), (0.2, math.inf), (0.2, 1e10))
        ),
        ("ab", ["a"] * 2, [math.nan, math.inf], {}, f"0 joints shown; {TWICE}; not a finite number: 'a'"),
        (
            *(TANK, ["TURET_Y", "TURRET_P"], [0.1, 0.2], {"TURRET_P": 0.2}),
            f"1 joint shown; unknown 'TURET_Y'. Did you mean 'TURRET_Y'? {KNOWN}",
        ),
        (
            *(TANK, [*["X" * 50] * 20_000, "TURRET_Y"], [0.1] * 20_001, {"TURRET_Y": 0.1}),
            f"1 joint shown; unknown {', '.join([repr('X' * 40)] * 3)} and 19997 more. {KNOWN}",
        ),
    ],
)
def test_positions_and_report_of_a_message(joints, name, position, values, said):
    found, report = match_joints(joints, joint_state(name, position))
    assert (found, str(report)) == (values, said)
    assert report.clean is (";" not in said)


def test_a_report_is_plain_values_with_a_short_repr():
    _, report = match_joints(TANK, joint_state(["TURRET_Y", "TURRET_P"], [0.5, -0.01]))
    assert repr(report) == "JointReport('2 joints shown')"
    assert report == JointReport(("TURRET_Y", "TURRET_P"))
    _, report = match_joints(["a", "b"], joint_state(["a", "b"], [1e10, 0.1, 0.1, 0.1]))
    assert {kind: n for kind, n in report.counts().items() if n} == {"matched": 1, "huge": 1, "long": 2}


@pytest.mark.parametrize(
    ("stamps_ms", "dropped", "said"),
    [
        ((100, 140, 120, 160), {120}, "1 joint shown"),
        ((1900, 900, 950), {900, 950}, "a late message was dropped"),
        ((5000, 20), set(), "1 joint shown; the publisher was restarted"),
        ((500, 0, 20), set(), "1 joint shown"),
        ((0, 0, 20, 20), set(), "1 joint shown"),
        ((-5,), set(), "1 joint shown"),
    ],
    ids=["a little back", "late ones do not move the clock", "far back", "zero restarts", "equal", "before 1970"],
)
def test_stamps_distinguish_late_messages_from_a_restart(stamps_ms, dropped, said):
    matcher = JointMatcher(TANK)
    for stamp in stamps_ms:
        values, report = matcher.match(joint_state(["TURRET_Y"], [0.1], stamp * 1_000_000))
        assert (values == {}) == (stamp in dropped) == report.dropped
    assert str(report) == said


def test_late_for_one_joint():
    matcher = JointMatcher(TANK)
    matcher.match(joint_state(TANK, [0.1, 0.1], 20_000_000))
    matcher.match(joint_state(["TURRET_P"], [0.2], 60_000_000))
    found, report = matcher.match(joint_state(TANK, [0.3, 0.3], 40_000_000))
    assert found == {"TURRET_Y": 0.3}
    assert str(report) == "1 joint shown; a late message was dropped for 'TURRET_P'"
    assert (report.dropped, report.counts()["unmoved"], report.counts()["late"]) == (False, 1, 1)


FREE = {"TURRET_Y": (-math.inf, math.inf), "TURRET_P": (-math.inf, math.inf)}


class TestOtherJoints:
    """An arm and a gripper, whose joints jump. Joints that two publishers share must not jump."""

    @pytest.mark.parametrize("publishers", [1, 2])
    @pytest.mark.parametrize("joints", [TANK, FREE])
    @pytest.mark.parametrize("age_ms", [0, 20, 900, None], ids=["now", "old", "older", "unstamped"])
    def test_all_are_shown(self, publishers, joints, age_ms):
        matcher = JointMatcher(joints, lambda: publishers)
        for i in range(50):
            arm, gripper, now_ms = 3.0 * (-1) ** i, 0.7 * (i % 2), 1000 + 20 * i
            found = matcher.match(joint_state(["TURRET_Y"], [arm], now_ms * 1_000_000))
            assert found == ({"TURRET_Y": arm}, JointReport(("TURRET_Y",)))
            stamp_ms = 0 if age_ms is None else now_ms - age_ms
            found = matcher.match(joint_state(["TURRET_P"], [gripper], stamp_ms * 1_000_000))
            assert found == ({"TURRET_P": gripper}, JointReport(("TURRET_P",)))

    def test_own_clocks(self):
        matcher, found = JointMatcher("ab", lambda: 2), []
        for joint, stamp_ms in (("a", 9000), ("b", 500), ("a", 8990), ("b", 520), ("a", 20), ("b", 540)):
            found.append(matcher.match(joint_state(joint, [0.1], stamp_ms * 1_000_000))[1].arrival.name)
        assert found == ["NEXT", "NEXT", "LATE", "NEXT", "RESTARTED", "NEXT"]

    def test_one_shared_joint(self):
        matcher = JointMatcher("abc", lambda: 2)
        for i in range(50):
            first = matcher.match(joint_state("ab", [0.1, 1.0], 20_000_000 * i))
            second = matcher.match(joint_state("bc", [-1.0, 0.3], 20_000_000 * i))
            assert (first[0], second[0]) == ({"a": 0.1, "b": 1.0}, {"c": 0.3})
        assert str(second[1]) == "1 joint shown; a message from another publisher was dropped for 'b'"

    def test_sharing_after_one_has_left(self):
        publishers = [3]
        matcher, found = JointMatcher("abc", lambda: publishers[0]), []
        for joint, position, publishers[0] in (("a", 1, 3), ("b", 1, 3), ("c", 1, 3), ("b", 3, 3), ("b", 1, 2)):
            found.append(matcher.match(joint_state([joint], [position]))[1].arrival.name)
        assert found == ["NEXT"] * 4 + ["ANOTHER"]

    def test_two_messages_of_one_publisher(self):
        publishers = [1]
        matcher = JointMatcher("ab", lambda: publishers[0])
        for publishers[0], names in ((1, "a"), (1, "b"), (2, "a")):
            matcher.match(joint_state(names, [0.1]))
        assert matcher.match(joint_state("b", [2.0]))[1].arrival is Arrival.ANOTHER


@dataclass
class Publisher:
    """A simulated publisher: its joints swing about a centre, and its clock starts at any time."""

    name: str
    begin: float  # [s] of its first message
    end: float
    clock: float  # [s], its first stamp
    rate: float  # [Hz]
    middle: float  # [rad]

    def messages(self, random, jitter):
        """Yield (time of arrival [s], name, message), in order: DDS keeps the order of each publisher's messages."""
        arrival = 0.0
        for i in range(round((self.end - self.begin) * self.rate)):
            age = i / self.rate
            arrival = max(arrival, self.begin + age + random.uniform(0, jitter))
            angle = self.middle + 0.3 * math.sin(age)
            message = joint_state(["TURRET_Y", "TURRET_P"], [angle, 0.1], round((self.clock + age) * 1e9))
            yield arrival, self.name, message


def follow(publishers, random, jitter, joints=TANK):
    """Match all messages with one matcher; return (time, publisher, report) for each."""
    now = 0.0
    matcher = JointMatcher(joints, lambda: sum(each.begin <= now < each.end + jitter for each in publishers))
    found = []
    for now, name, message in arrivals(publishers, random, jitter):
        found.append((now, name, matcher.match(message)[1]))
    return found


def arrivals(publishers, random, jitter):
    messages = [message for publisher in publishers for message in publisher.messages(random, jitter)]
    return sorted(messages, key=lambda message: message[0])


def turns(found):
    """Return whenever the shown publisher changes: (time, publisher)."""
    shown = [(when, name) for when, name, report in found if report.joints]
    return [each for before, each in pairwise([(0.0, ""), *shown]) if before[1] != each[1]]


RATES = st.sampled_from([10.0, 20.0, 50.0, 100.0])
OFFSETS = st.sampled_from([0.0, 0.003, 0.02, 0.03, 0.3, 0.99, 5.0, 500.0, 1.7e9])
SILENT = "the publisher was restarted or is silent, and the viewer follows a new one"


class TestTwoPublishers:
    @pytest.mark.parametrize("joints", [TANK, FREE], ids=["limits", "no limits"])
    @settings(max_examples=60)
    @given(OFFSETS, st.booleans(), RATES, RATES, st.sampled_from([0.0, 0.005, 0.03]), st.integers(0, 999))
    def test_one_is_followed_until_it_is_silent(self, joints, offset, is_ahead, rate, other_rate, jitter, seed):
        start, other_start = (10.0, 13.0 + offset) if is_ahead else (10.0 + offset, 13.0)
        one = Publisher("one", 0.0, 10.0, start, rate, 1.0)
        other = Publisher("other", 3.0, 14.0, other_start, other_rate, -1.0)
        found = follow([one, other], Random(seed), jitter, joints)
        settled = [turn for turn in turns(found) if turn[0] > 4.5]
        assert len(settled) <= 1  # either publisher, and the other one after it has left
        assert all(when > 9.5 and name == "other" for when, name in settled)
        assert found[-1][2].joints
        assert sum(report.arrival is Arrival.ANOTHER for _, _, report in found) > 50

    def test_short_slide(self):
        matcher = JointMatcher({"finger": (0.0, 0.05)}, lambda: 2)
        found = [matcher.match(joint_state(["finger"], [0.04 * (i % 2)], 10_000_000 * i))[1] for i in range(1, 101)]
        assert sum(report.arrival is Arrival.ANOTHER for report in found) > 40

    def test_stamps_make_it_keep_following_the_first_publisher(self):
        one, other = Publisher("one", 0, 9, 100, 50, 1.0), Publisher("other", 3, 12, 0, 50, -1.0)
        found = follow([one, other], Random(0), 0.005)
        assert [name for _, name in turns(found)] == ["one", "other"]
        reports = [str(report) for _, _, report in found]
        assert reports.count(f"2 joints shown; {SILENT}") <= 1
        assert "a message from another publisher was dropped" in reports
        assert not any(report.arrival in (Arrival.LATE, Arrival.RESTARTED) for when, _, report in found if when < 9)

    @pytest.mark.parametrize("joints", [TANK, FREE], ids=["limits", "no limits"])
    @pytest.mark.parametrize("lag_ms", [0, 3, None], ids=["one stamp", "own stamps", "unstamped"])
    def test_distinguished_by_position(self, joints, lag_ms):
        matcher = JointMatcher(joints, lambda: 2)
        for i in range(100):
            stamp_ns = 0 if lag_ms is None else 20_000_000 * i
            first = matcher.match(joint_state(TANK, [0.02 * i, 0.5], stamp_ns))
            second = matcher.match(joint_state(TANK, [-1.0, 0.5], stamp_ns + (lag_ms or 0) * 1_000_000))
            assert first == ({"TURRET_Y": 0.02 * i, "TURRET_P": 0.5}, JointReport(tuple(TANK)))
            assert second == ({}, JointReport(arrival=Arrival.ANOTHER))

    @pytest.mark.parametrize("other", [lambda i: 0.0, lambda i: -0.4 * i], ids=["at rest", "as fast"])
    def test_fast_wheel(self, other):
        matcher = JointMatcher(["WHEEL"], lambda: 2)
        for i in range(100):
            stamp_ns, position = 20_000_000 * i, 2.0 + 0.5 * i
            assert matcher.match(joint_state(["WHEEL"], [position], stamp_ns))[0] == {"WHEEL": position}
            assert matcher.match(joint_state(["WHEEL"], [other(i)], stamp_ns))[1].arrival is Arrival.ANOTHER

    @pytest.mark.parametrize("joints", [TANK, FREE], ids=["limits", "no limits"])
    @pytest.mark.parametrize("other_stamp_ms", [-500, 0, 5], ids=["older", "one stamp", "newer"])
    def test_a_publisher_that_sends_its_joints_in_turn(self, joints, other_stamp_ms):
        matcher, found = JointMatcher(joints, lambda: 2), []
        for i in range(100):
            stamp_ns = 1_000_000_000 + 20_000_000 * i
            matcher.match(joint_state(["TURRET_Y"], [0.02 * i], stamp_ns))
            matcher.match(joint_state(["TURRET_P"], [0.1], stamp_ns))
            found += [matcher.match(joint_state(["TURRET_Y"], [-1.0], stamp_ns + other_stamp_ms * 1_000_000))]
        assert {(tuple(values), report.arrival) for values, report in found[40:]} == {((), Arrival.ANOTHER)}

    @pytest.mark.parametrize("rate", [10, 20, 50])
    def test_fast_arm_without_stamps_beside_a_gripper_and_a_silent_one(self, rate):
        matcher, shown = JointMatcher(TANK, lambda: 3), 0
        for i in range(5 * rate):
            shown += bool(matcher.match(joint_state(["TURRET_Y"], [math.sin(3 * i / rate)]))[0])
            assert matcher.match(joint_state(["TURRET_P"], [0.1]))[0]
        assert shown > 4.4 * rate

    def test_fast_wheel_and_silence(self):
        matcher = JointMatcher(["WHEEL"], lambda: 2)
        found = [matcher.match(joint_state(["WHEEL"], [0.5 * i], 20_000_000 * i))[1].arrival for i in range(100)]
        assert found.count(Arrival.ANOTHER) == 1
        assert found.count(Arrival.NEXT) == 99

    def test_a_stalled_publisher_is_no_longer_followed(self):
        one, other = Publisher("one", 0, 9, 100, 50, 1.0), Publisher("other", 3, 12, 0, 50, -1.0)
        matcher = JointMatcher(TANK, lambda: 2)
        found = [
            (when, name, matcher.match(message)[1])
            for when, name, message in arrivals([one, other], Random(0), 0.0)
            if not (name == "one" and 5.0 < when < 6.0)
        ]
        assert [name for _, name in turns(found)] == ["one", "other"]
        assert [round(when, 1) for when, _, report in found if report.arrival is Arrival.SWITCHED] == [5.5]

    def test_a_single_restarted_publisher_is_shown_at_once(self):
        before, again = Publisher("one", 0, 4, 100, 50, 1.0), Publisher("again", 5, 7, 0, 50, -1.0)
        found = follow([before, Publisher("other", 2, 4, 50, 50, 0.0), again], Random(0), 0.0)
        first = next(report for _, name, report in found if name == "again")
        assert str(first).startswith("2 joints shown; the publisher was restarted")

    def test_when_the_followed_one_leaves_the_other_is_shown_at_once(self):
        one, other = Publisher("one", 0, 4, 100, 50, 1.0), Publisher("other", 2, 6, 0, 50, -1.0)
        found = follow([one, other], Random(0), 0.0)
        ((when, name, report),) = [each for each in found if each[2].arrival is Arrival.SWITCHED]
        assert (when, name) == (pytest.approx(4.0), "other")
        assert str(report).endswith(SILENT)

    def test_a_late_message_stays_late_after_a_visitor(self):
        publishers = [2]
        matcher, found = JointMatcher(TANK, lambda: publishers[0]), []
        for stamp_ms, publishers[0] in ((1000, 2), (500, 2), (1100, 1), (1200, 1), (1150, 1)):
            message = joint_state(["TURRET_Y"], [0.1], stamp_ms * 1_000_000)
            found.append(matcher.match(message)[1].arrival.name)
        assert found == ["NEXT", "ANOTHER", "NEXT", "NEXT", "LATE"]

    def test_beside_a_silent_one_a_restart_is_accepted_in_half_a_second(self):
        matcher, count = JointMatcher(TANK, lambda: 2), 0
        matcher.match(joint_state(["TURRET_Y"], [1.0], 50_000_000_000))
        while not matcher.match(joint_state(["TURRET_Y"], [0.0], count * 20_000_000))[0]:
            count += 1
        assert count < 25

    @pytest.mark.parametrize(
        ("joints", "publishers", "message"),
        [
            (TANK, 1, lambda i: ("TURRET_Y", 0.5 * (-1) ** i)),
            (TANK, 2, lambda i: (("TURRET_Y", "TURRET_P")[i % 2], 0.7 * (i % 2))),
            (["WHEEL"], 2, lambda i: ("WHEEL", 0.05 * (-1) ** i)),
        ],
        ids=["one alone", "those with other joints", "those that agree"],
    )
    def test_indistinguishable_publishers_are_all_shown(self, joints, publishers, message):
        matcher = JointMatcher(joints, lambda: publishers)
        for i in range(50):
            joint, position = message(i)
            assert matcher.match(joint_state([joint], [position], i * 20_000_000))[0] == {joint: position}
