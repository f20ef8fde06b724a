"""The doctor's rules on facts alone: each cause in two variants, and no cause for healthy graphs."""

import importlib
from dataclasses import replace
from math import inf
from random import Random

import pytest

from tutorial.ros.doctor.facts import Endpoint, Facts, Program, Topic
from tutorial.ros.doctor.report import report
from tutorial.ros.doctor.rules import RULES, diagnose
from tutorial.system.paths import HOME

TOPIC, JOINTS, IMU = "/Tank/joint_state", "sensor_msgs/msg/JointState", "sensor_msgs/msg/Imu"
TANK, VIEWER = Endpoint("/tank", JOINTS, "RIHS01_1"), Endpoint("/viewer", JOINTS, "RIHS01_1")
WELL = Facts(TOPIC, publishers=(TANK,), subscriptions=(VIEWER,), here=VIEWER, seconds=4.0, received=200, rate=50.0)
ALONE = replace(WELL, publishers=(), here=None, seconds=0.0, received=0, rate=0.0)
SILENT = replace(WELL, received=0, rate=0.0)


def apart(publisher: dict, subscription: dict) -> Facts:
    """Return facts in which a publisher and a subscription differ."""
    return replace(WELL, publishers=(replace(TANK, **publisher),), subscriptions=(replace(VIEWER, **subscription),))


OTHERS = (Topic("/Tank/joint_states", (JOINTS,), 1),)
ALIKE = (Topic("/Tank2/joint_state", (JOINTS,), 1),)
PYTHON = Program(4711, "python3", joined=True)
CASES = {
    "python": (
        Facts(TOPIC, import_error="the ROS 2 in /opt is for a different Python version"),
        Facts("/joy", import_error="No module named 'rclpy'"),
    ),
    "loopback": (Facts(TOPIC, loopback=False), Facts("/joy", loopback=False)),
    "participants": (
        Facts(TOPIC, joined=False, participants=32),
        replace(ALONE, participants=32, topics=OTHERS),
    ),
    "stopped": (
        replace(SILENT, programs=(replace(PYTHON, stopped=True),)),
        replace(ALONE, programs=(PYTHON, replace(PYTHON, stopped=True)), found_in=(5,)),
    ),
    "name": (
        replace(ALONE, topics=OTHERS, found_in=(5,)),
        replace(WELL, subscriptions=(), topics=(Topic("/Tank/joint_states", (JOINTS,)),)),
    ),
    "domain": (replace(ALONE, found_in=(5,)), replace(ALONE, found_in=(1, 2), topics=ALIKE)),
    "type": (apart({"type": IMU}, {}), replace(WELL, here=None, installed=False, received=0)),
    "hash": (apart({"hash": "RIHS01_2"}, {}), replace(SILENT, here=replace(TANK, hash="RIHS01_2"))),
    "reliability": (apart({"reliable": False}, {}), apart({"reliable": False, "transient_local": True}, {})),
    "durability": (apart({}, {"transient_local": True}), apart({}, {"transient_local": True, "reliable": False})),
    "deadline": (apart({}, {"deadline": 0.1}), apart({"deadline": 0.5}, {"deadline": 0.1})),
    "liveliness": (apart({}, {"manual": True}), apart({"lease": 2.0}, {"lease": 1.0})),
    "clock": (
        replace(SILENT, clock_users=("/tank",)),
        replace(SILENT, clock_users=("/tank", "/viewer"), clock_publishers=1),
    ),
    "silent": (SILENT, replace(SILENT, subscriptions=())),
    "late": (
        replace(SILENT, publishers=(replace(TANK, transient_local=True),), kept=1),
        replace(SILENT, topic="/Tank/robot_description"),
    ),
    "range": (replace(ALONE, reach="OFF"), replace(ALONE, programs=(PYTHON, replace(PYTHON, reach="OFF")))),
    "rmw": (
        replace(ALONE, programs=(replace(PYTHON, rmw="rmw_zenoh_cpp"),)),
        replace(ALONE, rmw="rmw_zenoh_cpp", programs=(replace(PYTHON, rmw="rmw_fastrtps_cpp"),)),
    ),
    "unknown": (
        replace(WELL, unmoved=200, complaint="0 joints shown; unknown 'TURET_Y'."),
        replace(WELL, unmoved=101, complaint="0 joints shown; unknown 'a', 'b'. Known: 'TURRET_P', 'TURRET_Y'."),
    ),
    "dropped": (
        replace(WELL, unmoved=200, complaint="0 joints shown; not a finite number: 'TURRET_Y'"),
        replace(WELL, unmoved=101, complaint="a late message was dropped"),
    ),
    "nobody": (ALONE, replace(ALONE, topics=(Topic("/imu", (IMU,), 1), Topic("/arm/angles", (JOINTS,), 1)))),
}


def test_a_publisher_is_silent_whatever_the_viewer_asks_for():
    asks = replace(VIEWER, transient_local=True)
    assert [each.name for each in diagnose(replace(SILENT, subscriptions=(asks,)))] == ["durability", "silent"]


@pytest.mark.parametrize("variant", [0, 1])
@pytest.mark.parametrize("name", CASES)
def test_each_cause_comes_first(name, variant):
    causes = diagnose(CASES[name][variant])
    assert causes[0].name == name
    assert f"1. {causes[0].rule.title[:2].capitalize()}" in report(CASES[name][variant])


def test_the_page_shows_a_report_and_every_rule(monkeypatch):
    monkeypatch.syspath_prepend(HOME / "book")
    table = importlib.import_module("cause_table")
    text = table.PAGE.read_text(encoding="utf-8")
    assert [*RULES] == [*CASES] == [*table.SIGNS]
    assert text == table.page()
    assert report(CASES["reliability"][0]) in text


@pytest.mark.parametrize(
    "other", ["/Tank/joint_states", "/joint_state", "/tank/jointState", "/joint", "/Tnak/jonit_state"]
)
def test_similar_names(other):
    cause = diagnose(replace(ALONE, topics=(Topic("/imu", (JOINTS,), 1), Topic(other, (JOINTS,), 1))))[0]
    assert cause.fill(cause.rule.command) == f"--ros-args -r {TOPIC}:={other}"


def test_a_similar_name_of_another_type_is_no_cause():
    assert diagnose(replace(ALONE, topics=(Topic("/Tank/joint_states", (IMU,), 1),)))[0].name == "nobody"


def test_one_fitting_publisher_is_enough():
    strange = replace(TANK, type=IMU)
    assert diagnose(replace(WELL, publishers=(strange, replace(TANK, reliable=False), TANK))) == []


def test_a_silent_publisher_may_have_published_before():
    assert [cause.name for cause in diagnose(SILENT)] == ["silent", "late"]


def test_other_domains_of_the_same_user():
    seen = tuple(replace(PYTHON, domain=domain) for domain in (0, 9, 42))
    cause = diagnose(replace(ALONE, looked_into=(1, 9), programs=seen))[0]
    assert "Some of your other programs use domain 42." in cause.found.saw


def test_several_misfits_are_all_reported():
    facts = apart({"type": IMU, "reliable": False}, {"deadline": 0.1, "manual": True})
    assert [cause.name for cause in diagnose(facts)] == ["type", "reliability", "deadline"]


def test_other_domains_and_programs_do_not_matter():
    elsewhere = Program(5, "x", domain=9, joined=True, stopped=True, reach="OFF", rmw="rmw_zenoh_cpp")
    assert diagnose(replace(ALONE, programs=(elsewhere,)))[0].name == "nobody"
    assert diagnose(replace(SILENT, programs=(elsewhere,)))[0].name == "silent"


def test_text_from_outside_is_escaped_and_quoted():
    evil = Topic("/Tank/joint_state;\x1b", (JOINTS,), 1)
    facts = replace(ALONE, subscriptions=(replace(VIEWER, node="/\x1b[2J"),), topics=(evil,))
    text = report(facts)
    assert "\x1b" not in text
    assert r":='/Tank/joint_state;\x1b'" in text


KEPT = replace(apart({"transient_local": True}, {"transient_local": True}), received=0, kept=2)


@pytest.mark.parametrize(
    ("facts", "said"),
    [
        (WELL, "50.0 messages a second arrive."),
        (replace(WELL, received=1, rate=0.0), "1 message arrived in 4.0 s."),
        (KEPT, "the publisher keeps 2 messages for late subscriptions, but has published nothing new."),
    ],
)
def test_all_is_well(facts, said):
    head = "/Tank/joint_state in domain 0: 1 publisher (/tank), 1 subscription (/viewer).\n"
    assert report(facts) == f"{head}All is well: {said}\n"


def test_a_quiet_log_is_well():
    assert report(replace(SILENT, topic="/rosout")).endswith("in 4.0 s, but nothing seems to be wrong.\n")


def healthy(random: Random) -> Facts:
    """Return the facts of a random graph in which each subscription has a compatible publisher, and messages arrive."""
    kinds, names = ("a_msgs/msg/A", "b_msgs/msg/B"), ("joint_state", "joint_states", "imu", "Tank/joint_state")
    kind, kept = random.choice(kinds), random.random() < 0.3

    def publisher(number: int) -> Endpoint:
        given = {name: random.random() < 0.5 for name in ("reliable", "manual")}
        spans = {name: random.choice((0.1, 1.0, inf)) for name in ("deadline", "lease")}
        return Endpoint(f"/p{number}", kind, "RIHS01_1", transient_local=kept, **given, **spans)

    def subscription(fits: Endpoint) -> Endpoint:
        asked = {name: getattr(fits, name) and random.random() < 0.5 for name in ("reliable", "manual")}
        spans = {name: getattr(fits, name) * random.choice((1, 2, inf)) for name in ("deadline", "lease")}
        return replace(fits, node="/s", hash=random.choice((fits.hash, "")), **asked, **spans)

    publishers = tuple(map(publisher, range(random.randint(1, 4))))
    sent = {"kept": 1} if kept else {"received": (count := random.randint(1, 500)), "unmoved": count // 3}
    return Facts(
        f"/{names[0]}",
        publishers=publishers,
        subscriptions=tuple(subscription(random.choice(publishers)) for _ in range(random.randint(0, 4))),
        here=Endpoint("the doctor", kind, "RIHS01_1", reliable=False),
        topics=tuple(Topic(f"/{name}", (random.choice(kinds),), random.randint(1, 3)) for name in names[1:]),
        programs=(replace(PYTHON, rmw="rmw_fastrtps_cpp"), replace(PYTHON, reach="SUBNET")),
        clock_users=tuple(each.node for each in publishers[:2]),
        clock_publishers=1,
        seconds=3.0,
        **sent,
    )


def test_no_cause_in_200_healthy_graphs():
    for seed in range(200):
        assert diagnose(healthy(Random(seed))) == [], seed
