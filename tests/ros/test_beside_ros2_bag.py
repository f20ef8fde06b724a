"""Bags of the pocket ROS 2 and of a real ``ros2 bag``: what the one has recorded the other reads and plays.

They run where the variable TANK_REAL_ROS2 names a command that runs another one with a real ROS 2.
"""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import threading
from contextlib import contextmanager

import pytest
from programs import PATIENCE, until
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

from tutorial.ros.bags import Bag, Player, Recorder, bag_info
from tutorial.ros.node_thread import NodeThread

REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
JOINTS, COUNT = "/Tank/joint_state", 100
KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
PAYLOADS = [serialize_message(JointState(name=["TURRET_Y"], position=[i / 10])) for i in range(COUNT)]
FIRST = serialize_message(JointState(name=["TURRET_Y"], position=[-1.0]))

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(300)]
if not REAL:
    pytest.skip("TANK_REAL_ROS2 is not set: it names a command that runs another with ROS 2", allow_module_level=True)


@pytest.fixture(params=["rmw_cyclonedds_cpp", "rmw_fastrtps_cpp"])
def environment(request, domain):
    return {**os.environ, "RMW_IMPLEMENTATION": request.param}


@pytest.fixture
def node(domain):
    with NodeThread("pocket") as thread:
        yield thread.node


def hear(node) -> list[bytes]:
    """The payloads that arrive from now on."""
    payloads: list[bytes] = []
    node.create_subscription(JointState, JOINTS, payloads.append, KEEP_ALL, raw=True)
    return payloads


@pytest.fixture
def publisher(node):
    return node.create_publisher(JointState, JOINTS, KEEP_ALL)


@contextmanager
def bag_command(environment, *arguments):
    """A ``ros2 bag`` that goes on, until Ctrl-C ends it."""
    command = [*REAL, "ros2", "bag", *map(str, arguments)]
    process = subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, start_new_session=True)
    try:
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
        process.wait(PATIENCE)


def real_info(environment, path):
    command = [*REAL, "ros2", "bag", "info", str(path)]
    return subprocess.run(command, env=environment, check=True, capture_output=True, text=True, timeout=PATIENCE).stdout


def words(info):
    """The lines of an info in any order: real ones have the topics in that of a hash table."""
    return sorted(line.removeprefix("Topic information:").strip() for line in info.splitlines())


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_what_a_real_one_has_recorded_is_read_and_played(environment, node, publisher, tmp_path, storage):
    path, everything = tmp_path / "bag", tmp_path / "qos.yaml"
    everything.write_text(f"{JOINTS}: {{history: keep_all, reliability: reliable, durability: volatile}}")
    how = ("-s", storage, "-o", path, "--qos-profile-overrides-path", everything)
    with bag_command(environment, "record", *how, "--topics", JOINTS):
        until(lambda: publisher.get_subscription_count() == 1, "the recorder")
        publisher.publish(FIRST)  # the recorder may know of the publisher a little later: only then it acknowledges
        until(publisher.wait_for_all_acked, "the recorder knows of the publisher")
        for payload in PAYLOADS:
            publisher.publish(payload)
            threading.Event().wait(0.01)  # so it is played
        until(publisher.wait_for_all_acked, "what was published has arrived")
    bag = Bag(path)
    recorded = [data for _, _, data in bag.raw_messages([JOINTS])]
    assert recorded in (PAYLOADS, [FIRST, *PAYLOADS])
    assert bag.damage == ""
    assert words(bag_info(bag)) == words(real_info(environment, path))
    node.destroy_publisher(publisher)
    heard = hear(node)
    Player(node, bag, topics=[JOINTS]).run(threading.Event())
    until(lambda: len(heard) == len(recorded), "what was played")
    assert heard == recorded


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_real_one_reads_and_plays_what_is_recorded_here(environment, node, publisher, tmp_path, storage):
    path, heard = tmp_path / "bag", hear(node)
    with NodeThread("recorder") as thread, Recorder(thread.node, path, [JOINTS], storage, 10.0) as recorder:
        until(lambda: publisher.get_subscription_count() == 2 and recorder.hears(JOINTS), "the match")
        for payload in PAYLOADS:
            publisher.publish(payload)
            threading.Event().wait(0.005)  # so it is played, from a history of ten
    node.destroy_publisher(publisher)
    assert words(real_info(environment, path)) == words(bag_info(Bag(path)))
    until(lambda: len(heard) == COUNT, "what was published")
    heard.clear()
    with bag_command(environment, "play", path, "--delay", "3", "--loop") as playing:  # once more, until it is met
        until(lambda: heard[-COUNT:] == PAYLOADS or playing.poll() is not None, "what was played, from its beginning")
        assert heard[-COUNT:] == PAYLOADS
