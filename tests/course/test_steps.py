"""Step 3 as a whole, as a user runs it: real processes that talk over real topics."""

from __future__ import annotations

import asyncio
import json
import re
import signal
from itertools import pairwise

import psutil
import pytest
from browser import Witness, chromium, open_browser, pixels
from browser import until as browser_until
from domains import reserved_domain
from programs import PATIENCE, until
from rclpy.utilities import get_rmw_implementation_identifier
from sensor_msgs.msg import JointState

from tutorial.paths import HOME
from tutorial.ros.bags import Bag
from tutorial.ros.node_thread import NodeThread

CRANE = HOME / "project" / "models" / "crane.xml"
STEP_NS = 20_000_000


@pytest.fixture
def node(domain):
    """A node of the test's own, whose callbacks run on a thread of their own."""
    with NodeThread("tester") as thread:
        yield thread.node


@pytest.fixture
def listen(node):
    """Collect what is published on a topic."""

    def listen(topic="/Tank/joint_state"):
        messages = []
        node.create_subscription(JointState, topic, messages.append, 100)
        return messages

    return listen


def stamp_ns(message):
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def read(directory):
    return {path.stem: json.loads(path.read_text()) for path in directory.glob("*.json")}


def test_the_launched_step_3_drives_publishes_and_is_seen(program, listen, tmp_path):
    heard = listen()
    running = program("launch", "step3", "--duration", 10, "--headless", "--report", tmp_path)
    assert running.ends() == 0, running.output
    running.leaves_nothing()
    records = read(tmp_path)

    assert sorted(records) == ["joystick", "simulation", "viewer"]
    for name, record in records.items():
        assert set(record) == {"node", "ros", "seconds", "joints", "topics", "report"}
        assert record["node"] == name
        assert record["ros"] in ("underlay", "rclpy")
        assert {"matched", "unknown", "non_finite", "short", "duplicate", "late"} < set(record["report"])
    simulation, viewer, joystick = (records[name] for name in ("simulation", "viewer", "joystick"))

    assert simulation["seconds"] == 10.0
    assert simulation["topics"]["/Tank/joint_state"]["published"] == 500
    assert joystick["topics"]["/joy"]["published"] > simulation["topics"]["/joy"]["received"] > 100
    shown = viewer["topics"]["/Tank/joint_state"]
    assert shown["applied"] == shown["received"] > 100
    assert 0 < shown["latency_ms"]["median"] <= shown["latency_ms"]["p99"]
    assert viewer["report"].pop("matched") == 2 * shown["applied"]
    assert not any(viewer["report"].values())
    until(lambda: viewer["joints"] == dict(zip(heard[-1].name, heard[-1].position)), "the last message")
    assert viewer["joints"] == simulation["joints"]
    steps = {after - before for before, after in zip(map(stamp_ns, heard), map(stamp_ns, heard[1:]))}
    assert steps == {STEP_NS}, "stamps are 20 ms apart"
    turned = [abs(message.position[0]) for message in heard]
    raised = [abs(message.position[1]) for message in heard]
    assert max(turned) > 0.01 or max(raised) > 0.02, "the turret has moved"


def test_the_launched_step_7_shows_pose_and_joints_together(program, tmp_path):
    running = program("launch", "step7", "--duration", 6, "--headless", "--report", tmp_path)
    assert running.ends() == 0, running.output
    records = read(tmp_path)
    simulation, viewer = (records[name] for name in ("simulation", "viewer"))
    assert {simulation["topics"][topic]["published"] for topic in ("/tf", "/Tank/odom", "/Tank/joint_state")} == {300}
    joints, transforms = (viewer["topics"][topic] for topic in ("/Tank/joint_state", "/tf"))
    assert 50 < joints["applied"] <= min(joints["received"], transforms["received"])
    assert viewer["joints"] == simulation["joints"]
    missed = 2 * 300 - joints["received"] - transforms["received"]  # a busy machine overtakes step 2's publisher
    alone = {f"{count} without a partner of the same stamp" for count in range(1, missed + 1)}
    assert set(re.findall(r"not shown so far: (.*?)\s*$", running.output, re.MULTILINE)) <= alone


def test_the_turret_moves_with_the_right_stick(program, listen, tmp_path):
    drive = tmp_path / "drive.yaml"
    drive.write_text("drive:\n  - {time: 0.2, axes: [0, 0, 1, 1]}\n  - {time: 0.7, axes: [0, 0, 0, 0]}\n")
    heard = listen()
    simulation = program("run", "step2", "--headless", "--ros-args", "-r", "__node:=simulation")
    joystick = program("joy", "--drive", drive)
    until(lambda: heard and heard[-1].position[0] < -0.5, "a turn to the left, which is negative: the axis points down")
    until(lambda: heard[-1].position[1] > 0.5, "a raised barrel")
    for running in (joystick, simulation):
        running.asks_to_stop()
        assert running.ends() == 0
        running.leaves_nothing()


def test_the_rail_moves_the_barrel_and_the_viewer_shows_it(program, listen, tmp_path):
    drive = tmp_path / "drive.yaml"
    drive.write_text("drive:\n  - {time: 0.5, axes: [0, 1.0]}\n  - {time: 4.5, axes: [0, 0.3]}\n")
    heard = listen()
    drains = ("--duration", 1, "--linger", 2 * PATIENCE)  # it ends when the simulation has gone and all is shown
    viewer = program("run", "step3", "--headless", "--report", tmp_path, *drains, "--ros-args", "-r", "__node:=viewer")
    viewer.says("- JointStateSubscriber")
    simulation = program("run", "step2", "--headless", "--ros-args", "-r", "__node:=simulation")
    joystick = program("joy", "--drive", drive)
    until(lambda: heard and heard[-1].position[1] > -0.0098 + 0.02, "the rail lifting the barrel")
    for running in (simulation, joystick):
        running.asks_to_stop()
        assert running.ends() == 0
    assert viewer.ends() == 0
    shown = read(tmp_path)["viewer"]["joints"]
    until(lambda: shown == dict(zip(heard[-1].name, heard[-1].position)), "the last message")
    assert shown["TURRET_P"] > 0.01
    assert abs(shown["TURRET_Y"]) < 0.05, "no turret command was given"


def test_the_same_viewer_project_shows_another_robot(program, node, tmp_path):
    drains = ("--duration", 0.5, "--linger", PATIENCE)  # it ends when the publisher has gone and all is shown
    viewer = program("run", "step3", "--robot", CRANE, "--headless", "--report", tmp_path, *drains)
    publisher = node.create_publisher(JointState, "/Crane/joint_state", 1)
    until(publisher.get_subscription_count, "the viewer")
    viewer.says("+ Crane")
    message = JointState(name=["LUFF", "BRIDGE", "SLEW"], position=[0.25, -0.125, 0.5])
    message.header.stamp.sec = 1
    publisher.publish(message)
    publisher.wait_for_all_acked()
    node.destroy_publisher(publisher)
    assert viewer.ends() == 0
    record = read(tmp_path)["tank"]
    assert record["joints"] == {"BRIDGE": -0.125, "SLEW": 0.5, "LUFF": 0.25}
    assert record["topics"]["/Crane/joint_state"]["applied"] == 1


OWN = """
from sensor_msgs.msg import JointState
from tutorial.controller import SimpleController

class JointStatePublisher(SimpleController):
    def configure(self, config):
        self.node = config.node
        self.publisher = self.node.create_publisher(JointState, f"{config.body.name}/joint_state", 1)

    def control(self):
        self.publisher.publish(JointState(name=["MINE"]))

    def unconfigure(self):
        self.node.destroy_publisher(self.publisher)
"""


def test_a_users_own_controller_takes_the_librarys_place(program, listen, tmp_path):
    heard = listen()
    (tmp_path / "mine.py").write_text(OWN)
    running = program("run", "step2", "--headless", "--controller", tmp_path / "mine.py")
    until(lambda: heard, "a message")
    assert heard[0].name == ["MINE"]
    running.asks_to_stop()
    assert running.ends() == 0, running.output


def test_a_killed_simulation_leaves_the_viewer_alive_and_a_new_one_is_picked_up(program, listen, tmp_path):
    heard = listen()
    viewer = program("run", "step3", "--headless", "--report", tmp_path, "--ros-args", "-r", "__node:=viewer")
    simulate = ("run", "step2", "--headless", "--ros-args", "-r", "__node:=simulation")
    first = program(*simulate)
    lives = 6 if "fastrtps" in get_rmw_implementation_identifier() else 1.5  # [s], longer than the second is not met
    until(lambda: heard and stamp_ns(heard[-1]) > lives * 1e9, "the first simulation")
    first.process.kill()
    assert first.ends() == -signal.SIGKILL
    before = len(heard)
    assert viewer.process.poll() is None

    second = program(*simulate)
    until(lambda: len(heard) > before + 50, "the second simulation")
    stamps = [stamp_ns(message) for message in heard]
    assert any(after < earlier for earlier, after in pairwise(stamps)), "its stamps start over"
    viewer.says("the publisher was started again")
    second.asks_to_stop()
    assert second.ends() == 0
    viewer.asks_to_stop()
    assert viewer.ends() == 0
    record = read(tmp_path)["viewer"]
    assert record["joints"] in [dict(zip(message.name, message.position)) for message in heard[-3:]]
    assert record["report"]["late"] == 0
    for running in (first, second, viewer):
        running.leaves_nothing()


def test_nothing_is_left_of_a_launched_step_whose_launcher_is_killed(program):
    running = program("launch", "step3", "--duration", 300)
    running.says("viewer     | look at")
    running.says("simulation | look at")
    ports = {int(line.rsplit(":", 1)[1].strip().strip("/")) for line in running.lines if "look at" in line}
    assert len(ports) == 2
    family = {process.pid for process in running.family()}
    connections = [each for each in psutil.net_connections("tcp") if each.pid in family]
    owned = {each.laddr.port for each in connections if each.status == psutil.CONN_LISTEN}
    assert owned == ports, "they go with the processes that have them"
    running.process.kill()
    running.leaves_nothing()


def test_the_launched_step_8_leaves_a_bag_of_all_that_was_published(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    running = program("launch", "step8", "--duration", 2, "--headless", "--report", tmp_path / "report")
    assert running.ends() == 0, running.output
    published = read(tmp_path / "report")["simulation"]["topics"]["/Tank/joint_state"]["published"]
    (path,) = tmp_path.glob("rosbag2_*")
    bag = Bag(path)
    assert [tuple(topic) for topic in bag.topics] == [("/Tank/joint_state", "sensor_msgs/msg/JointState", published)]
    assert published == 100
    assert not bag.damage


def test_two_nodes_of_one_name_are_said_in_plain_words(program):
    first = program("run", "step3", "--headless")
    first.says("+ Tank")
    second = program("run", "step3", "--headless")
    second.says("there are 2 nodes of the name /tank")
    assert "--ros-args -r __node:=tank_2" in second.output


def test_two_runs_at_once_do_not_hear_each_other(program, listen):
    heard = listen()
    with reserved_domain() as other:
        simulation = program("run", "step2", "--headless", environment={"ROS_DOMAIN_ID": str(other)})
        simulation.says("+ Simulator")
        mine = program("run", "step2", "--headless", "--duration", 5)  # Fast DDS takes up to 4 s to find it
        assert mine.ends() == 0
        assert heard
        assert len({stamp_ns(message) for message in heard}) == len(heard), "one simulation is heard, not two"
        simulation.asks_to_stop()
        assert simulation.ends() == 0


@pytest.mark.browser
def test_both_pages_show_the_turret_moving(program, tmp_path):
    path = chromium()
    drive = tmp_path / "drive.yaml"
    drive.write_text(
        "repeat: true\n"
        "drive:\n"
        "  - {time: 0, axes: [0, 0, 0.8, 0.2]}\n"
        "  - {time: 1.5, axes: [0, 0, -0.8, -0.2]}\n"
        "  - {time: 3, axes: []}\n"
    )
    simulation = program("run", "step2", "--ros-args", "-r", "__node:=simulation")
    viewer = program("run", "step3", "--ros-args", "-r", "__node:=viewer")
    program("joy", "--drive", drive)
    for running, line in ((simulation, ""), (viewer, "Tank: 2 joints shown")):
        running.says("look at http://127.0.0.1:")
        address = running.output.split("look at ")[1].split()[0]
        asyncio.run(sees_movement(path, address, line))


async def sees_movement(path, address, line):
    """Open a page, and wait until its picture has changed and the line below it says what it should."""
    async with open_browser(path) as page:
        witness = Witness(page)
        await page.goto(address)
        await page.wait_for_selector("#curtain", state="hidden")
        first = await pixels(page, "#pane")

        async def moved():
            return (abs(await pixels(page, "#pane") - first).max(axis=2) > 40).sum() > 100

        async def says():
            return (await page.text_content("#line")).startswith(line)

        await browser_until(moved, f"the tank moving on {address}")
        await browser_until(says, f"{line!r} below the picture")
        assert not witness.complaints
