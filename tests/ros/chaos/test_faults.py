"""Each fault's effect on a message, its reproducibility by seed, and a matcher's report of it."""

import math
from copy import deepcopy
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import JointState

from tutorial.errors import TutorialError
from tutorial.ros.chaos import FAULTS, Action, Chaos, parse_fault
from tutorial.ros.chaos.faults import AHEAD_NS, BURST, CHANGES, LATE_NS, stamp_ns
from tutorial.ros.chaos.stream import JOINTS, swing

ALL = dict.fromkeys(FAULTS, 0.2)
FIVE = tuple(f"JOINT_{i}" for i in range(5))


def stream(chaos: Chaos, count: int = 300, joints: tuple[str, ...] = JOINTS) -> list[Action]:
    return [action for i in range(count) for action in chaos.apply(swing(i, joints))]


def entries(message: JointState) -> list[tuple[str, float, float, float]]:
    return list(zip(message.name, message.position, message.velocity, message.effort))


def test_a_seed_gives_the_same_stream_again():
    first, again, other = (repr(stream(Chaos(ALL, seed))) for seed in (3, 3, 4))
    assert first == again
    assert first != other


def test_a_faults_hits_do_not_depend_on_other_faults():
    def nans(faults):
        chaos = Chaos(faults, seed=1)
        return [any(map(math.isnan, a.message.position)) for i in range(200) for a in chaos.apply(swing(i))]

    alone = nans({"nan": 0.3})
    assert 30 < sum(alone) < 90
    assert nans({"shuffle": 0.5, "nan": 0.3}) == alone


@given(st.dictionaries(st.sampled_from(list(FAULTS)), st.just(1.0)), st.integers(0, 4))
def test_the_good_message_is_not_changed(faults, joints):
    good = swing(7, FIVE[:joints])
    before = deepcopy(good)
    Chaos(faults).apply(good)
    assert good == before


HIT = {
    "shuffle": lambda good, hit: hit.name != good.name and sorted(entries(hit)) == sorted(entries(good)),
    "subset": lambda good, hit: (
        0 < len(hit.name) < 5 and entries(hit) == [each for each in entries(good) if each[0] in hit.name]
    ),
    "rename": lambda good, hit: len({*hit.name} - {*good.name}) == 1 and list(hit.position) == list(good.position),
    "duplicate": lambda good, hit: (  # the last one is the newest
        entries(hit)[1:] == entries(good)
        and hit.name[0] in good.name
        and hit.position[0] != good.position[good.name.index(hit.name[0])]
    ),
    "nan": lambda good, hit: [*map(math.isnan, hit.position)].count(True) == 1,
    "infinite": lambda good, hit: [*map(math.isinf, hit.position)].count(True) == 1,
    "huge": lambda good, hit: [abs(value) >= 1e12 for value in hit.position].count(True) == 1,
    "markup": lambda good, hit: entries(hit)[:-1] == entries(good) and any(c in hit.name[-1] for c in "<&`"),
    "control": lambda good, hit: entries(hit)[:-1] == entries(good) and not hit.name[-1].isprintable(),
    "short": lambda good, hit: 0 < len(hit.position) == len(hit.velocity) == len(hit.effort) < len(hit.name) == 5,
    "long": lambda good, hit: len(hit.name) == 5 < len(hit.position) <= 8 and hit.position[:5] == good.position,
    "ahead": lambda good, hit: AHEAD_NS[0] <= stamp_ns(hit) - stamp_ns(good) <= AHEAD_NS[1],
}
"""The relation between a message that a fault has hit, and the good one."""


@pytest.mark.parametrize("name", HIT)
def test_each_faults_effect(name):
    chaos = Chaos()
    chaos.apply(swing(99, FIVE))
    chaos.faults = {name: 1}
    good = swing(100, FIVE)
    ((kind, hit),) = chaos.apply(good)
    assert chaos.made == dict.fromkeys(FAULTS, 0) | {name: 1}
    assert (kind, HIT[name](good, hit)) == ("publish", True), hit
    assert "\0" not in "".join(hit.name)  # \0 ends a string in C, so the name would be cut


def test_a_late_message_arrives_unchanged_after_newer_ones():
    chaos = Chaos({"late": 0.1})
    messages = [action.message for action in stream(chaos, 500)]
    stamps = [stamp_ns(message) for message in messages]
    back = [before - stamp for before, stamp in pairwise(stamps) if stamp < before]
    assert len(back) == chaos.made["late"] > 20
    assert LATE_NS[0] <= min(back) < max(back) <= LATE_NS[1] + stamp_ns(swing(1))
    assert all(message == swing(round(stamp_ns(message) / stamp_ns(swing(1)))) for message in messages)


def test_a_restart_resets_the_stamps_and_drops_delayed_messages():
    chaos = Chaos({"late": 0.5, "restart": 0.05})
    began = 0
    for number in range(500):
        for action in chaos.apply(swing(number)):
            if action.kind == "restart":
                began = number
            else:
                assert 0 <= stamp_ns(action.message) <= stamp_ns(swing(number - began))


def test_drop_burst_and_second_publisher():
    assert Chaos({"drop": 1}).apply(swing(0)) == []
    burst = Chaos({"burst": 1}).apply(swing(0))
    assert burst == [Action("publish", swing(0))] * BURST
    good, second = Chaos({"second": 1}).apply(swing(9))
    assert (good.kind, second.kind) == ("publish", "second")
    assert (list(second.message.position), second.message.header) == ([0.0, 0.0], swing(9).header)


@pytest.mark.parametrize(
    ("message", "count"),
    [
        (JointState(), 0),
        (JointState(position=[1.0]), 0),
        (JointState(name=["A"], position=[1.0]), 1),
    ],
)
def test_a_message_without_all_positions_stays_unchanged(message, count):
    chaos = Chaos(dict.fromkeys(CHANGES, 1.0))
    chaos.apply(message)
    assert {chaos.made[name] for name in CHANGES} == {count}


def test_a_fault_is_written_with_its_share():
    assert [parse_fault(text) for text in ("nan", "nan:0.1")] == [("nan", 1.0), ("nan", 0.1)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("shufle", "there is no fault 'shufle'. Did you mean 'shuffle'?"),
        ("\x1b[2J:1", r"there is no fault '\\x1b[2J'."),
        ("nan:2", "the share of messages that 'nan' affects cannot be 2: give a number from 0 to 1."),
        ("nan:", "cannot be nan"),
    ],
)
def test_an_invalid_fault_is_refused(text, said):
    with pytest.raises(TutorialError) as error:
        parse_fault(text)
    assert said in str(error.value)
