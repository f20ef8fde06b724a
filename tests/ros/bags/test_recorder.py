"""The recorder writes every message to the bag, byte for byte, and reports losses."""

import threading
import time
from functools import cache
from unittest.mock import Mock

import pytest
from builtin_interfaces.msg import Time
from programs import until
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from tutorial.errors import TutorialError
from tutorial.ros.bags import Bag, Recorder
from tutorial.ros.bags import recorder as module
from tutorial.ros.bags.qos import offered
from tutorial.ros.node_thread import NodeThread

COUNT = 400
KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)


@pytest.fixture
def nodes(domain):
    with NodeThread("talker") as talker, NodeThread("recorder") as recorder:
        yield talker.node, recorder.node


@cache  # Fast DDS leaves garbage in the padding
def payloads(count=COUNT):
    joints = (JointState(name=["TURRET_Y", "TURRET_P"], position=[i / 100, 0.5]) for i in range(count))
    return [serialize_message(message) for message in joints]


def publish(recorder, publisher, messages):
    """Publish once publisher and recorder have matched."""
    topic = publisher.topic_name
    until(lambda: publisher.get_subscription_count() and recorder.hears(topic), "the match")
    for message in messages:
        publisher.publish(message)


def recorded(bag, topic="/a"):
    return [data for _, _, data in Bag(bag).raw_messages([topic])]


@pytest.fixture
def publisher(nodes):
    return nodes[0].create_publisher(JointState, "/a", KEEP_ALL)


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_every_message_is_recorded_byte_for_byte(nodes, publisher, tmp_path, storage):
    with Recorder(nodes[1], tmp_path / "bag", storage=storage) as recorder:
        until(lambda: "/a" in recorder.counts, "the topic")
        publish(recorder, publisher, payloads())
        until(lambda: recorder.counts["/a"] == COUNT, "all of them")
    assert recorded(recorder.path) == payloads()
    assert (recorder.counts["/a"], recorder.lost) == (COUNT, 0)
    bag = Bag(recorder.path)
    assert (bag.duration, bag.damage) == (recorder.duration, "")
    assert "type_description_hash: RIHS01_a13ee3a330e346c9d8" in (recorder.path / "metadata.yaml").read_text()


def test_the_last_messages_are_recorded_although_the_executor_is_busy(nodes, publisher, tmp_path):
    nodes[1].create_subscription(String, "/busy", lambda _: time.sleep(0.3), 1)
    busy = nodes[0].create_publisher(String, "/busy", 1)
    until(busy.get_subscription_count, "the match")
    with Recorder(nodes[1], tmp_path / "bag", ["/a"]) as recorder:
        publish(recorder, publisher, [])
        busy.publish(String())
        publish(recorder, publisher, payloads())
        nodes[0].destroy_publisher(publisher)
    assert recorded(recorder.path) == payloads()


def test_with_simulated_time_clock_is_the_time_of_receipt(nodes, publisher, tmp_path):
    nodes[1].set_parameters([Parameter("use_sim_time", value=True)])
    clock = nodes[0].create_publisher(Clock, "/clock", 1)
    with Recorder(nodes[1], tmp_path / "bag", ["/a"]) as recorder:
        publish(recorder, publisher, payloads(1))  # simulated time is not known yet
        until(lambda: recorder._received, "the message before the time")
        until(clock.get_subscription_count, "the match")
        clock.publish(Clock(clock=Time(sec=5)))
        until(lambda: nodes[1].get_clock().now().nanoseconds, "the time")
        publish(recorder, publisher, payloads(1))
        until(lambda: recorder.counts["/a"], "the message")
    assert [time_ns for _, time_ns, _ in Bag(recorder.path).raw_messages(["/a"])] == [5_000_000_000]


def test_a_late_topic_is_recorded_with_its_quality_of_service(nodes, tmp_path):
    talker, node = nodes
    kept = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    hurried = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    with Recorder(node, tmp_path / "bag") as recorder:
        latched = talker.create_publisher(String, "/latched", kept)
        latched.publish(String(data="before anybody listened"))
        fast = talker.create_publisher(String, "/fast", hurried)
        hidden = talker.create_publisher(String, "/_hidden", 1)
        until(lambda: {"/latched", "/fast"} <= set(recorder.counts), "the topics")
        publish(recorder, fast, [String(data="now")])
        until(lambda: recorder.counts["/latched"] and recorder.counts["/fast"], "the messages")
    bag = Bag(recorder.path)
    said = [(topic, message.data) for topic, _, message in bag.messages(["/latched"])]
    assert said == [("/latched", "before anybody listened")]
    assert offered(bag.channel("/latched").qos).durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert offered(bag.channel("/fast").qos).reliability == ReliabilityPolicy.BEST_EFFORT
    assert hidden.topic_name not in bag.channels


def test_only_the_given_topics_are_recorded(nodes, tmp_path):
    talker, node = nodes
    publishers = [talker.create_publisher(String, topic, 1) for topic in ("/a", "/b", "/_hidden")]
    with Recorder(node, tmp_path / "bag", ["a", "/_hidden", "/nobody"]) as recorder:
        until(lambda: set(recorder.counts) == {"/a", "/_hidden"}, "the topics")
        publish(recorder, publishers[0], [String(data="x")])
        until(lambda: recorder.counts["/a"], "the message")
    assert recorder.counts == {"/a": 1, "/_hidden": 0}


def test_an_invalid_name_is_refused_before_any_file_is_created(nodes, tmp_path):
    with pytest.raises(TutorialError, match="topic name"):
        Recorder(nodes[1], tmp_path / "bag", ["a-b"])
    assert not (tmp_path / "bag").exists()


@pytest.mark.pocket
def test_an_unknown_type_is_reported_once(nodes, tmp_path, caplog, monkeypatch):
    looks = Mock(return_value={"/a": ["alien_msgs/msg/\x1b[2J"], "//x": ["std_msgs/msg/String"]})
    monkeypatch.setattr(module, "topics_with_types", looks)
    monkeypatch.setattr(module, "publishers_on", Mock())
    with Recorder(nodes[1], tmp_path / "bag") as recorder:
        until(lambda: looks.call_count > 3, "some looks")
    assert recorder.counts == {}
    said = [record.message for record in caplog.records if "is not recorded" in record.message]
    assert said == [
        "topic //x is not recorded: its name breaks ROS 2's naming rules",
        r"topic /a is not recorded: The message type 'alien_msgs/msg/\x1b[2J' is invalid",
    ]


def test_a_full_disk_ends_the_recording_with_advice(nodes, publisher, tmp_path, caplog, monkeypatch):
    """The messages written so far can be read."""
    recorder = Recorder(nodes[1], tmp_path / "bag", ["/a"]).__enter__()
    publish(recorder, publisher, payloads(10))
    until(lambda: sum(topic.count for topic in Bag(recorder.path).topics) == 10, "ten messages on the disk")
    full = Mock(side_effect=OSError(28, "No space left on device"))
    monkeypatch.setattr(recorder._writer._file._file, "write", full)
    publish(recorder, publisher, payloads(10))
    until(lambda: recorder.error is not None, "the error")
    publish(recorder, publisher, payloads(10))
    until(lambda: recorder.lost >= 10, "the losses")
    with pytest.raises(TutorialError, match=r"No space left on device\. .*Free some space, or record to a differ"):
        recorder.close()
    assert recorded(recorder.path) == payloads(10)
    assert [record.message for record in caplog.records if "can no longer be written" in record.message]


def test_the_queue_for_a_slow_disk_is_bounded_and_losses_are_reported(nodes, publisher, tmp_path, caplog, monkeypatch):
    monkeypatch.setattr(module, "MOST_WAITING", 100 * len(payloads(1)[0]))
    stuck = threading.Event()
    with Recorder(nodes[1], tmp_path / "bag", ["/a"]) as recorder:
        publish(recorder, publisher, [])
        write = recorder._writer.write
        monkeypatch.setattr(recorder._writer, "write", lambda *message: (stuck.wait(60), write(*message)))
        publish(recorder, publisher, payloads())
        until(lambda: recorder.lost, "a loss")
        stuck.set()
    assert recorder.counts["/a"] + recorder.lost == COUNT
    assert recorder.counts["/a"] >= 100
    assert any("messages are being lost: the disk is too slow" in record.message for record in caplog.records)


def test_a_recorder_without_its_node_completes_its_bag(publisher, tmp_path):
    thread = NodeThread("gone")
    recorder = Recorder(thread.node, tmp_path / "bag", ["/a"]).__enter__()
    publish(recorder, publisher, payloads(1))
    until(lambda: recorder.counts["/a"] == 1, "the message")
    thread.close()
    recorder.close()
    recorder.close()
    assert Bag(tmp_path / "bag").damage == ""
