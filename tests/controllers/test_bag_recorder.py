"""Step 8's controller: the bag has all published messages, and a slow disk blocks no callback."""

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
    """A node that receives nothing; its clock has stopped."""

    resolve_topic_name = "/{}".format

    def get_clock(self):
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=1_750_000_000_000_000_000))


@pytest.fixture
def recorder(tmp_path, monkeypatch):
    monkeypatch.setattr(BagRecorder, "folder", tmp_path)
    controller = BagRecorder()
    controller.configure(SimpleNamespace(node=Silent(), body=SimpleNamespace(name="Tank")))
    return controller


def test_a_slow_disk_blocks_no_callback_and_loses_nothing(recorder, monkeypatch):
    answers, written = threading.Event(), []
    write = recorder.bag.write

    def slowly(*message):
        answers.wait(60)
        write(*message)
        written.append(message)

    monkeypatch.setattr(recorder.bag, "write", slowly)
    payloads = [serialize_message(JointState(position=[float(i)])) for i in range(50)]
    for payload in payloads:
        recorder.on_joint_state(payload)  # if this blocks, the test never ends
    assert not written
    answers.set()
    recorder.unconfigure()
    assert len(written) == 50
    assert recorder.node.topics == []
    bag = Bag(recorder.bag.path)
    assert [tuple(topic) for topic in bag.topics] == [("/Tank/joint_state", "sensor_msgs/msg/JointState", 50)]
    assert [payload for *_, payload in bag.raw_messages()] == payloads, "byte for byte"


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_a_full_disk_does_not_fill_the_queue(recorder, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(recorder.bag, "write", full)
    recorder.on_joint_state(PAYLOAD)
    recorder.writer.join(60)
    for _ in range(50):
        recorder.on_joint_state(PAYLOAD)
    assert recorder.received.empty()
    recorder.unconfigure()
