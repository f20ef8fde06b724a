"""The doctor and a real ROS 2: all faults on it, and one side's doctor on the other side's programs."""

import os
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest
from programs import TANK, TIMEOUT, until
from sensor_msgs.msg import Joy

from tutorial.ros.node_thread import NodeThread

REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
JOY, KIND = "/joy", "sensor_msgs/msg/Joy"
UNRELIABLE, RELIABLE = (("--qos-reliability", policy) for policy in ("best_effort", "reliable"))

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(300)]
if not REAL:
    pytest.skip("TANK_REAL_ROS2 is not set to a command that runs other commands on ROS 2", allow_module_level=True)


@pytest.fixture(params=[pytest.param("rmw_cyclonedds_cpp", marks=pytest.mark.nightly), "rmw_fastrtps_cpp"])
def rmw(request, monkeypatch) -> str:
    monkeypatch.setenv("RMW_IMPLEMENTATION", request.param)
    return request.param


def test_all_faults_on_a_real_ros_2(rmw):
    files = [str(Path(__file__).with_name(name)) for name in ("test_doctor_faults.py", "test_machine.py")]
    run = [*REAL, sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *files]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert "a real ROS 2 is in use" in done.stdout


@contextmanager
def running(*command: str) -> Iterator[None]:
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True)
    try:
        yield
    finally:
        os.killpg(process.pid, signal.SIGINT)
        process.wait(timeout=TIMEOUT)


def finds(text: str, *tank: str) -> None:
    """Ask the doctor until it reports this text: ``ros2`` takes a moment to start."""
    ask = partial(subprocess.run, [*tank, "doctor", JOY, "--domain", "0"], capture_output=True, text=True, check=False)
    until(lambda: text in ask().stdout, text)


@pytest.mark.parametrize("side", [[TANK], [*REAL, TANK]], ids=["pocket", "real"])
def test_programs_of_a_real_ros_2(rmw, domain, side):
    publish, echo = ([*REAL, "ros2", "topic", each, JOY] for each in ("pub", "echo"))
    with running(*publish, KIND, "-r", "20"):
        finds("All is well: ", *side)
    with running(*publish, KIND, "-r", "20", *UNRELIABLE), running(*echo, KIND, *RELIABLE):
        finds("1. The reliability settings are incompatible\n", *side)
    with running(*publish, "std_msgs/msg/String"), running(*echo, KIND):
        finds("1. The message types differ\n", *side)
    with running(*echo, KIND):
        finds("1. Nobody publishes the topic\n", *side)


def test_programs_of_the_pocket_ros_2(rmw, domain):
    with running(TANK, "topic", "pub", "-r", "20", JOY, KIND):
        finds("All is well: ", *REAL, TANK)
    with running(TANK, "topic", "pub", "-r", "20", "/Joy", KIND), running(*REAL, "ros2", "topic", "echo", JOY, KIND):
        finds("1. The topic's name differs\n", *REAL, TANK)


@pytest.mark.parametrize("echo", [(TANK,), (*REAL, "ros2")], ids=["pocket", "real"])
def test_other_hash(rmw, domain, monkeypatch, echo):
    with NodeThread("stick") as thread:
        with monkeypatch.context() as patch:
            patch.setattr("rclpy._cyclone.type_hash", lambda _: f"RIHS01_{'0' * 64}")
            publisher = thread.node.create_publisher(Joy, JOY, 1)
        thread.node.create_timer(0.05, lambda: publisher.publish(Joy()))
        with running(*echo, "topic", "echo", JOY):
            finds("1. The definitions of the message type differ\n", *REAL, TANK)
