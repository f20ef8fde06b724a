"""Playing a bag with the recorded bytes, order, times and quality of service."""

import threading
import time
from contextlib import contextmanager
from functools import partial
from unittest.mock import Mock

import pytest
from programs import TIMEOUT, until
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from tutorial.errors import TutorialError
from tutorial.ros.bags import Bag, Player
from tutorial.ros.bags.qos import qos_text
from tutorial.ros.bags.storage import Channel
from tutorial.ros.bags.writer import BagWriter
from tutorial.ros.node_thread import NodeThread

START = 1_700_000_000 * 10**9
STRING = "std_msgs/msg/String"
LATCHED = QoSProfile(depth=9, durability=DurabilityPolicy.TRANSIENT_LOCAL)
CHANNELS = (
    Channel("/a", STRING),
    Channel("/b", STRING, qos=qos_text([LATCHED])),
    Channel("/clock", "rosgraph_msgs/msg/Clock"),
    Channel("/alien", "alien_msgs/msg/X"),
    Channel("/json", STRING, encoding="json"),
    Channel("/a b", STRING),
)


def make(path, count=30, step=0.01, last=None):
    """Write a bag of `count` messages, alternately on /a and /b; the last one may come much later [s]."""
    writer = BagWriter(path)
    for channel in CHANNELS:
        writer.add_channel(channel)
        first = Clock() if channel.topic == "/clock" else String(data="first")
        writer.write(channel.topic, START, START, serialize_message(first))
    for i in range(count):
        at = START + round((step * i if last is None or i < count - 1 else last) * 1e9)
        writer.write(CHANNELS[i % 2].topic, at, at, serialize_message(String(data=str(i))))
    writer.close()
    return Bag(path)


@pytest.fixture
def nodes(domain):
    with NodeThread("player") as player, NodeThread("listener") as listener:
        yield player.node, listener.node


@pytest.fixture
def heard(nodes):
    """The messages that arrive on /a and /b: topic, payload, and time of arrival [s]."""
    got: list[tuple[str, bytes, float]] = []
    for topic in ("/a", "/b"):
        hear = partial(lambda topic, payload: got.append((topic, payload, time.monotonic())), topic)
        nodes[1].create_subscription(String, topic, hear, 1000, raw=True)
    until(lambda: nodes[0].count_subscribers("/a") and nodes[0].count_subscribers("/b"), "the subscriptions")
    return got


@contextmanager
def playing(player):
    """Play on a thread, which must end soon after it is asked to stop."""
    stop = threading.Event()
    thread = threading.Thread(target=player.run, args=(stop,))
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join(TIMEOUT)
    assert not thread.is_alive()


def texts(heard, topic):
    return [deserialize_message(payload, String).data for name, payload, _ in heard if name == topic]


def test_all_messages_are_played_in_order_and_on_time(nodes, heard, tmp_path):
    bag = make(tmp_path / "bag", count=60)
    calls = []
    player = Player(nodes[0], bag, rate=2.0)
    player.run(threading.Event(), lambda played: calls.append((time.monotonic(), played)))
    until(lambda: len(heard) == 62, "the messages")
    for topic in ("/a", "/b"):
        recorded = [payload for *_, payload in bag.raw_messages([topic])]
        payloads = [payload for name, payload, _ in heard if name == topic]
        whole = [payload[: len(then)] for payload, then in zip(payloads, recorded, strict=True)]  # DDS pads
        assert whole == recorded, "byte for byte"
    assert player.played == 63  # including the bag's own /clock
    seconds = [played for _, played in calls]
    began = min(now - played / 2 for now, played in calls)
    assert heard[-1][2] - began > 0.9 * bag.duration / 2  # an upper bound would depend on the machine
    assert seconds == sorted(seconds)
    assert seconds[-1] == pytest.approx(bag.duration)


def test_unplayable_messages_are_reported(nodes, tmp_path, caplog):
    Player(nodes[0], make(tmp_path / "bag"))
    said = [record.message for record in caplog.records if "is not played" in record.message]
    assert said == [
        "topic /a b is not played: the name breaks ROS 2's naming rules",
        "topic /alien is not played: The message type 'alien_msgs/msg/X' is invalid",
        "topic /json is not played: its messages are 'json', not 'cdr'",
    ]


@pytest.mark.parametrize(
    ("topic", "asked", "clock", "on"),
    [
        ("a", None, 0, ["/a"]),
        ("a", ["/a"], 0, ["/a"]),
        ("~/a", None, 0, ["/player/a"]),
        ("clock", None, 0, ["/clock"]),
        ("clock", None, 50, []),
    ],
)
def test_relative_topics(nodes, tmp_path, topic, asked, clock, on):
    writer = BagWriter(tmp_path / "bag")
    for name in (topic, "/b"):
        writer.add_channel(Channel(name, "std_msgs/String"))
        writer.write(name, START, START, serialize_message(String()))
    writer.close()
    there = Mock(wraps=nodes[0])
    Player(there, Bag(tmp_path / "bag"), topics=asked, clock=clock).run(threading.Event())
    made = [call.args[1] for call in there.create_publisher.call_args_list if call.args[0] is String]
    assert [nodes[0].resolve_topic_name(name) for name in made if name != "/b"] == on


def test_only_some_topics_from_the_middle(nodes, heard, tmp_path):
    Player(nodes[0], make(tmp_path / "bag"), rate=100.0, topics=["/b"], start_offset=0.2).run(threading.Event())
    until(lambda: len(heard) == 5, "the messages")
    assert texts(heard, "/b") == ["21", "23", "25", "27", "29"]


def test_a_loop_over_one_message_pauses_in_between(nodes, tmp_path):
    player = Player(nodes[0], make(tmp_path / "bag", count=1), topics=["/b"], loop=True)
    with playing(player):
        until(lambda: player.played, "the first round")
        began, before = time.monotonic(), player.played
        until(lambda: player.played >= before + 10, "some rounds")
        assert time.monotonic() - began > 9 * 0.02


def test_clock_is_the_bags_time_instead_of_its_own_clock(nodes, heard, tmp_path):
    clocks = []
    best_effort = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
    nodes[1].create_subscription(Clock, "/clock", clocks.append, best_effort)
    until(lambda: nodes[0].count_subscribers("/clock"), "the subscription")
    player = Player(nodes[0], make(tmp_path / "bag", count=100), rate=4.0, clock=50.0)
    player.run(threading.Event())
    until(lambda: len(heard) == 102 and len(clocks) > 5, "the messages")
    times = [clock.clock.sec * 10**9 + clock.clock.nanosec - START for clock in clocks]
    assert player.played == 102
    assert times == sorted(set(times))
    assert set(times) <= set(range(0, 10**9, 80_000_000))


def test_publishers_offer_the_recorded_quality_of_service(nodes, heard, tmp_path):
    """They are removed at the end, even if the bag is stopped between messages that are centuries apart."""
    late = []
    with playing(Player(nodes[0], make(tmp_path / "bag", count=2, last=7e9), rate=1e-9)):
        until(lambda: texts(heard, "/b"), "the first message on /b")
        offers = {topic: nodes[0].get_publishers_info_by_topic(topic)[0].qos_profile for topic in ("/a", "/b")}
        durability = {topic: qos.durability for topic, qos in offers.items()}
        nodes[1].create_subscription(String, "/b", late.append, LATCHED)
        until(lambda: late, "the messages kept for a late subscriber")
    assert durability == {"/a": DurabilityPolicy.VOLATILE, "/b": DurabilityPolicy.TRANSIENT_LOCAL}
    until(lambda: not nodes[0].get_publishers_info_by_topic("/a"), "the publisher's removal")


def test_a_payload_that_ros_2_rejects_is_reported_once(nodes, heard, tmp_path, caplog, monkeypatch):
    """Fast DDS rejects one that is longer than its type allows."""
    player = Player(nodes[0], make(tmp_path / "bag"), rate=10.0)
    make_publisher = nodes[0].create_publisher

    def refusing(kind, topic, qos):
        publisher = make_publisher(kind, topic, qos)
        if topic == "/a":
            publisher.publish = Mock(side_effect=RuntimeError("cannot publish data"))
        return publisher

    monkeypatch.setattr(nodes[0], "create_publisher", refusing)
    player.run(threading.Event())
    until(lambda: len(heard) == 16, "the messages on /b")
    assert player.played == 17
    said = [record.message for record in caplog.records if "is skipped" in record.message]
    assert said == ["a message on /a is skipped, as are similar messages: cannot publish data"]


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"rate": 0.0}, "the rate is 0; give a rate above 0, such as 2"),
        ({"start_offset": 5.0}, "the start offset is 5 s, but the bag is 0.290 s long"),
        ({"topics": ["/aa"]}, "there is no topic '/aa' in this bag. Did you mean '/a'"),
        ({"topics": ["/alien"]}, "there is nothing to play"),
    ],
    ids=str,
)
def test_senseless_options_are_refused_before_playing(domain, tmp_path, how, said):
    with NodeThread("player") as thread, pytest.raises(TutorialError) as caught:
        Player(thread.node, make(tmp_path / "bag"), **how)
    assert said in str(caught.value)
