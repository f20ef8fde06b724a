"""A node that counts messages and spins on its own thread. To its program, it looks like a node of rclpy."""

import sys
import threading
from contextlib import nullcontext
from functools import partial
from unittest.mock import Mock

import pytest
from programs import TIMEOUT, until
from sensor_msgs.msg import JointState, Joy
from std_msgs.msg import String

from tutorial.program.record import make_record
from tutorial.ros.node_thread import NodeThread, TopicMeter


@pytest.fixture
def thread(domain):
    with NodeThread("tank") as thread:
        yield thread


@pytest.fixture
def node(thread):
    return thread.node


def send(publisher, count, *texts):
    """Publish once `count` subscriptions have been found."""
    until(lambda: publisher.get_subscription_count() == count, "the match")
    for text in texts:
        publisher.publish(String(data=text))


def test_a_callback_may_take_the_message_alone(node):
    got = []
    callbacks = [
        lambda message: got.append(("one", message.data)),
        lambda message, name="default": got.append((name, message.data)),
        lambda *arguments: got.append(("any", len(arguments))),
        partial(lambda name, message: got.append((name, message.data)), "partial"),
        lambda message, info: got.append(("two", message.data, sorted(info)[-1])),
    ]
    for callback in callbacks:
        node.create_subscription(String, "words", callback, 1)
    send(node.create_publisher(String, "words", 1), len(callbacks), "a")
    until(lambda: len(got) == len(callbacks), "all of them to be called")
    wanted = [("any", 1), ("default", "a"), ("one", "a"), ("partial", "a"), ("two", "a", "source_timestamp")]
    assert sorted(got) == wanted


@pytest.mark.parametrize("callback", [lambda: 0, lambda message, *, info: 0, partial(lambda message: 0, "")])
def test_a_callback_with_wrong_parameters_is_refused_and_leaves_nothing(node, callback):
    before = list(node.subscriptions)
    with pytest.raises(RuntimeError, match="callback should be either be callable with one argument"):
        node.create_subscription(String, "words", callback, 1)
    assert (list(node.subscriptions), node.meters) == (before, [])


def test_coroutine_functions_are_passed_to_rclpy(node, backend):
    got = []

    async def on_words(message):
        got.append(message.data)

    with pytest.raises(ImportError, match="coroutine") if backend == "pocket" else nullcontext():
        node.create_subscription(String, "words", on_words, 1)
        send(node.create_publisher(String, "words", 1), 1, "a")
        until(lambda: got == ["a"], "the callback")


def test_its_entities_are_rclpys(node):
    publisher = node.create_publisher(msg_type=String, topic="words", qos_profile=1)
    subscription = node.create_subscription(msg_type=String, topic="words", callback=print, qos_profile=1)
    assert publisher in node.publishers
    assert subscription in node.subscriptions
    with pytest.raises(TypeError):
        publisher.publish("a")
    assert node.meters[0].count == 0


@pytest.mark.parametrize("failure", [SystemExit, KeyboardInterrupt, GeneratorExit, ValueError])
def test_a_callbacks_exception_is_reported_and_the_node_goes_on(thread, caplog, failure):
    heard = Mock(side_effect=[failure, None])
    thread.node.create_subscription(String, "words", lambda message: heard(message.data), 10)
    send(thread.node.create_publisher(String, "words", 10), 1, "first", "second")
    until(lambda: [call.args for call in heard.mock_calls] == [("first",), ("second",)], "both messages")
    assert isinstance(thread.error, failure)
    assert "a callback of the node 'tank' failed; other callbacks continue" in caplog.text


def test_a_destroyed_node_can_be_closed(thread):
    thread.node.create_subscription(String, "words", print, 1)
    thread.node.destroy_node()
    thread.close()
    assert not thread._thread.is_alive()


@pytest.fixture
def meter():
    return TopicMeter(Joy, "/joy", "received")


def test_a_meter_counts_and_keeps_the_newest_message(meter):
    assert (meter.count, meter.rate, meter.last) == (0, 0.0, None)
    assert meter.type_name == "sensor_msgs/msg/Joy"
    meter.add(1_000_000, 1_000_000)
    assert meter.latency_ms() == {"median": None, "p99": None}  # it needs two
    meter.add(3_000_000, 3_000_000)
    assert (meter.count, meter.last) == (2, 3_000_000)
    assert meter.rate > 0
    assert meter.latency_ms() == {"median": 2.0, "p99": 2.98}


@pytest.fixture
def many_switches():
    """Make threads switch all the time."""
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(interval)


def test_if_the_graph_fails_a_node_counts_itself(thread, monkeypatch):
    """A real ROS 2 lists no nodes while any node's name is empty."""
    monkeypatch.setattr(thread.node, "get_node_names_and_namespaces", Mock(side_effect=RuntimeError))
    assert thread.namesakes() == 1


@pytest.mark.usefixtures("many_switches")
def test_latencies_can_be_read_while_messages_arrive(meter, monkeypatch):
    monkeypatch.setattr(meter, "_latencies_ns", type(meter._latencies_ns)(maxlen=100))
    stop = threading.Event()

    def receive():
        while not stop.is_set():
            meter.add("message", 1_000_000)

    thread = threading.Thread(target=receive)
    thread.start()
    try:
        for _ in range(1000):
            meter.latency_ms()
    finally:
        stop.set()
        thread.join()


def test_a_hanging_callback_does_not_block_close(domain, monkeypatch, caplog):
    monkeypatch.setattr(NodeThread, "timeout", 0.1)
    entered, release = threading.Event(), threading.Event()

    def wait():
        entered.set()
        release.wait()

    stuck = NodeThread("stuck")
    stuck.node.create_timer(0.001, wait)
    assert entered.wait(60)
    stuck.close()
    stuck.close()
    assert "a callback of the node 'stuck' does not return: it is at " in caplog.text
    with NodeThread("other") as other:
        until(lambda: "stuck" in other.node.get_node_names(), "its node, which is still there")
        release.set()
        until(lambda: "stuck" not in other.node.get_node_names(), "its leaving after all")


def test_a_topic_that_is_published_and_received_is_counted_twice(node):
    publisher = node.create_publisher(String, "words", 10)
    node.create_subscription(String, "words", lambda message: None, 10)
    send(publisher, 1, "a", "b", "c")
    until(lambda: all(meter.count == 3 for meter in node.meters), "the messages")
    counts = make_record("echo", 1.0, node.meters)["topics"]["/words"]
    assert (counts["published"], counts["received"]) == (3, 3)
    assert counts["latency_ms"]["median"] is not None


def test_a_view_does_not_wait_for_recorded_joint_states(node):
    for raw in (False, True):
        node.create_subscription(JointState, "/Tank/joint_state", print, 1, raw=raw)
    assert [(meter.raw, meter.brings_joint_states) for meter in node.meters] == [(False, True), (True, False)]


def test_an_interrupted_close_can_be_continued(thread, monkeypatch):
    def interrupted(_timeout):
        monkeypatch.undo()
        raise KeyboardInterrupt

    monkeypatch.setattr(thread._thread, "join", interrupted)
    with pytest.raises(KeyboardInterrupt):
        thread.close()
    thread.close()
    assert not thread._thread.is_alive()
    assert not thread._context.ok()


def test_a_paused_node_runs_no_callback(thread):
    begun, returned = [], []

    def call():
        begun.append(1)
        threading.Event().wait(0.01)
        returned.append(1)

    thread.node.create_timer(0.001, call)
    for _ in range(10):
        with thread.paused():
            count = len(begun)
            assert count == len(returned)
        until(lambda count=count: len(begun) > count, "another call")


def test_a_repeated_error_is_logged_now_and_then(node, caplog, monkeypatch):
    monkeypatch.setattr("tutorial.ros.node_thread.COMPLAIN_EVERY", TIMEOUT)
    fail = Mock(side_effect=ValueError)
    node.create_timer(0.001, fail)
    until(lambda: fail.call_count > 3, "some failures")
    assert caplog.text.count("a callback of the node 'tank' failed; other callbacks continue") == 1


@pytest.mark.usefixtures("many_switches")
def test_destroying_an_entity_during_a_spin_is_no_error(thread, caplog):
    for _ in range(500):
        thread.node.destroy_publisher(thread.node.create_publisher(String, "words", 1))
        thread.node.destroy_subscription(thread.node.create_subscription(String, "words", print, 1))
    assert thread.error is None, caplog.text


def test_destroying_an_entity_without_its_node_is_reported(thread, backend):
    if backend == "pocket":
        pytest.skip("the pocket executor continues without it; see tests/ros/pocket/test_topics.py")
    thread.node.create_subscription(String, "words", print, 1).destroy()
    until(lambda: thread.error, "the executor's error")
    assert str(thread.error) == "cannot use Destroyable because destruction was requested"
