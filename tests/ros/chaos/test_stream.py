"""The stream, between nodes: what is published where."""

import math
from contextlib import ExitStack

import pytest
from programs import until
from rclpy.qos import HistoryPolicy, QoSProfile
from sensor_msgs.msg import JointState

from tutorial.ros.chaos import Chaos
from tutorial.ros.chaos.stream import TOPIC, ChaosStream, swing
from tutorial.ros.node_thread import NodeThread

KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL)


class Ends:
    """A node that publishes, and one that listens."""

    def __init__(self, stack):
        self.chaos, self.listener = (stack.enter_context(NodeThread(name)) for name in ("chaos", "listener"))
        self.received = []
        self.listener.node.create_subscription(JointState, TOPIC, self.received.append, KEEP_ALL)

    def start(self, faults, **how):
        return ChaosStream(self.chaos.node, Chaos(faults), **how)


@pytest.fixture
def ends(domain):
    with ExitStack() as stack:
        ends = Ends(stack)
        yield ends
        assert ends.chaos.error is ends.listener.error is None


def test_it_swings_steadily_by_itself(ends):
    ends.start({})
    until(lambda: len(ends.received) > 10, "messages")
    first = ends.received[0].header.stamp
    number = round(50 * (first.sec + first.nanosec / 1e9))
    positions = [list(message.position) for message in ends.received[:10]]
    assert positions == [list(swing(number + i).position) for i in range(10)]


def test_the_faults_go_to_the_topic_from_where_the_good_stream_comes_elsewhere(ends):
    ends.start({"nan": 1}, good="good")
    good = ends.listener.node.create_publisher(JointState, "/good", KEEP_ALL)
    until(lambda: good.get_subscription_count() and ends.listener.node.count_publishers(TOPIC), "each other")

    def arrives():
        good.publish(JointState(name=["A"], position=[1.0]))
        return ends.received

    until(arrives, "a message")
    assert ends.received[0].name == ["A"]
    assert math.isnan(ends.received[0].position[0])


def test_a_loop_is_refused(ends):
    with pytest.raises(Exception, match=r"are both on '/Tank/joint_state'\. Have the good stream's publisher publish"):
        ends.start({}, good=TOPIC[1:])


def test_a_second_publisher_and_a_new_start(ends):
    """On a real ROS 2, too, who is destroyed leaves nothing."""
    stream = ends.start({"second": 0.5})
    node = ends.listener.node
    until(lambda: node.count_publishers(TOPIC) == 2, "two publishers")
    until(lambda: {message.position[0] == 0 for message in ends.received} == {True, False}, "both publishers' messages")
    stream.chaos.faults = {"restart": 0.02}
    until(lambda: stream.chaos.made["restart"] > 1, "a restart")
    stream.chaos.faults = {}
    count = len(ends.received)
    until(lambda: len(ends.received) > count + 5, "messages after the restart")
    until(lambda: node.count_publishers(TOPIC) == 2, "no more publishers than before")
