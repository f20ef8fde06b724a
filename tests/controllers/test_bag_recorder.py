"""Step 8's controller: what is published of the body is in the bag, and a slow disk holds up nobody."""

import threading
from types import SimpleNamespace

import pytest
from controlled import Node
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from tutorial.controllers.bag_recorder import BagRecorder
from tutorial.ros.bags import Bag

PAYLOAD = serialize_message(JointState(name=["TURRET_Y"], position=[0.5]))


class Silent(Node):
    """A node on which nothing arrives; its clock has stopped."""

    resolve_topic_name = "/{}".format

    def get_clock(self):
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=1_750_000_000_000_000_000))


@pytest.fixture
def recorder(tmp_path, monkeypatch):
    monkeypatch.setattr(BagRecorder, "folder", tmp_path)
    controller = BagRecorder()
    controller.configure(SimpleNamespace(node=Silent(), body=SimpleNamespace(name="Tank")))
    return controller


def test_a_slow_disk_holds_up_no_callback_and_nothing_is_lost(recorder, monkeypatch):
    answers, written = threading.Event(), []
    write = recorder.bag.write

    def slowly(*message):
        answers.wait(60)
        write(*message)
        written.append(message)

    monkeypatch.setattr(recorder.bag, "write", slowly)
    payloads = [serialize_message(JointState(position=[float(i)])) for i in range(50)]
    for payload in payloads:
        recorder.on_joint_state(payload)  # it returns, or this test never ends
    assert not written
    answers.set()
    recorder.unconfigure()
    assert len(written) == 50
    assert recorder.node.topics == []
    bag = Bag(recorder.bag.path)
    assert [tuple(topic) for topic in bag.topics] == [("/Tank/joint_state", "sensor_msgs/msg/JointState", 50)]
    assert [payload for *_, payload in bag.raw_messages()] == payloads, "byte for byte"


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_when_the_disk_is_full_nothing_piles_up(recorder, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(recorder.bag, "write", full)
    recorder.on_joint_state(PAYLOAD)
    recorder.writer.join(60)
    for _ in range(50):
        recorder.on_joint_state(PAYLOAD)
    assert recorder.received.empty()
    recorder.unconfigure()
