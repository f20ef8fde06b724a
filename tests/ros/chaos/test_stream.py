"""The stream between nodes: what it publishes, and on which topic."""

import math

import pytest
from programs import until
from rclpy.qos import HistoryPolicy, QoSProfile
from sensor_msgs.msg import JointState

from tutorial.ros.chaos import Chaos
from tutorial.ros.chaos.stream import TOPIC, ChaosStream, swing
from tutorial.ros.node_thread import NodeThread

KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL)


@pytest.fixture
def nodes(domain):
    """A publishing node and a listening one."""
    with NodeThread("chaos") as chaos, NodeThread("listener") as listener:
        yield chaos.node, listener.node
        assert chaos.error is listener.error is None


@pytest.fixture
def received(nodes):
    received = []
    nodes[1].create_subscription(JointState, TOPIC, received.append, KEEP_ALL)
    return received


def test_it_swings_steadily_by_itself(nodes, received):
    ChaosStream(nodes[0], Chaos())
    until(lambda: len(received) > 10, "messages")
    first = received[0].header.stamp
    number = round(50 * (first.sec + first.nanosec / 1e9))
    positions = [list(message.position) for message in received[:10]]
    assert positions == [list(swing(number + i).position) for i in range(10)]


def test_faults_go_to_the_topic_and_the_good_stream_comes_from_another(nodes, received):
    chaos, listener = nodes
    ChaosStream(chaos, Chaos({"nan": 1}), good="good")
    good = listener.create_publisher(JointState, "/good", KEEP_ALL)
    until(lambda: good.get_subscription_count() and listener.count_publishers(TOPIC), "each other")

    def arrives():
        good.publish(JointState(name=["A"], position=[1.0]))
        return received

    until(arrives, "a message")
    assert received[0].name == ["A"]
    assert math.isnan(received[0].position[0])


def test_a_loop_is_refused(nodes):
    with pytest.raises(Exception, match=r"are both on '/Tank/joint_state'\. Start the good stream's publisher"):
        ChaosStream(nodes[0], Chaos(), good=TOPIC[1:])


def test_a_second_publisher_and_a_restart(nodes, received):
    """A destroyed publisher leaves nothing behind, even on a real ROS 2."""
    chaos, listener = nodes
    stream = ChaosStream(chaos, Chaos({"second": 0.5}))
    until(lambda: listener.count_publishers(TOPIC) == 2, "two publishers")
    until(lambda: {message.position[0] == 0 for message in received} == {True, False}, "both publishers' messages")
    stream.chaos.faults = {"restart": 0.02}
    until(lambda: stream.chaos.made["restart"] > 1, "a restart")
    stream.chaos.faults = {}
    count = len(received)
    until(lambda: len(received) > count + 5, "messages after the restart")
    until(lambda: listener.count_publishers(TOPIC) == 2, "no more publishers than before")
