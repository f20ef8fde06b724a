"""``tank bag``: record, inspect and play a drive."""

import json

import pytest
from rclpy.qos import qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, Joy

from tutorial.ros.bags import Bag
from tutorial.ros.node_thread import NodeThread

JOINTS = "/Tank/joint_state"


@pytest.fixture
def node(tank):
    """A node beside the commands, with a joystick that turns the turret."""
    with NodeThread("beside") as thread:
        joy = thread.node.create_publisher(Joy, "/joy", 1)
        thread.node.create_timer(0.1, lambda: joy.publish(Joy(axes=[0.0, 0.0, 0.0, 0.5, 0.0, 0.0])))
        yield thread.node


def test_a_drive_is_recorded_and_played(tank, node, tmp_path):
    path, heard, clocks = tmp_path / "run", [], []
    run = tank("run step2 --headless --duration 4 --bag", path, "--report", tmp_path)
    assert run.status == 0
    drive = [message for *_, message in Bag(path).messages([JOINTS])]
    published = json.loads((tmp_path / "tank.json").read_text())["topics"][JOINTS]["published"]
    assert len(drive) == published == 200
    assert {topic.name for topic in Bag(path).topics if topic.count} == {JOINTS, "/joy"}

    played = tank("bag play", path, "--rate", 4, "--topics", JOINTS)
    assert (played.status, played.stdout.endswith("stops it\n200 messages played\n")) == (0, True)

    (path / "metadata.yaml").unlink()  # a killed recorder leaves none
    info = tank("bag info", path)
    assert f"Topic: {JOINTS} | Type: sensor_msgs/msg/JointState | Count: 200 " in info.stdout
    assert "This bag is damaged, and is read as far as possible: its metadata.yaml is missing" in info.stderr
    node.create_subscription(JointState, JOINTS, heard.append, 200)
    node.create_subscription(Clock, "/clock", clocks.append, qos_profile_sensor_data)
    loop = f"bag play --loop --clock 40 --rate 4 --topics {JOINTS} --"
    endless = tank(loop, path, once=lambda: drive[-1] in heard and clocks)
    assert (endless.status, "messages played\n" in endless.stdout) == (0, True)


def test_recording_waits_for_a_publisher(tank, tmp_path):
    run = tank("bag record /nobody -s sqlite3 -o", tmp_path / "bag", once="Ctrl-C stops it\n")
    assert (run.status, "0 messages of 0 topics in 0.0 s\n" in run.stdout) == (0, True)
    assert Bag(tmp_path / "bag").damage == ""
    played = tank("bag play", tmp_path / "bag")
    assert (played.status, "Error: there is nothing to play" in played.stderr) == (1, True)
