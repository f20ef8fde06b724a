"""How the tools of a real ROS 2 read the robot description. The tests need TANK_REAL_ROS2.

As in ``tests/ros/test_beside_ros2.py``, this is a command that runs another command with ROS 2. RMW_IMPLEMENTATION
selects its middleware; the default is Cyclone DDS.
"""

import os
import re
import shlex
import signal
import subprocess
from contextlib import ExitStack, contextmanager
from itertools import count
from types import SimpleNamespace

import pytest
from programs import TIMEOUT, until
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from tutorial.body import Body
from tutorial.controllers.robot_description_publisher import RobotDescriptionPublisher
from tutorial.description.urdf import robot_description
from tutorial.ros.domains import reserved_domain
from tutorial.ros.node_thread import NodeThread
from tutorial.system.paths import HOME
from tutorial.world import Placement

REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
RMW = os.environ.get("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")
MODELS = HOME / "project" / "models"
NAMES = ("Tank", "Crane")

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(300)]
if not REAL:
    pytest.skip("TANK_REAL_ROS2 is not set to a command that runs other commands on ROS 2", allow_module_level=True)


@pytest.fixture(scope="module")
def bodies():
    return {name: Body.displayed(Placement(name, MODELS / f"{name.lower()}.xml")) for name in NAMES}


@pytest.fixture(scope="module")
def environment():
    with reserved_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        yield {**os.environ, "ROS_DOMAIN_ID": str(domain), "RMW_IMPLEMENTATION": RMW}


@pytest.fixture(scope="module")
def node(environment, bodies):
    """A node of the pocket ROS 2 that publishes both descriptions."""
    thread = NodeThread("tank")
    publishers = [RobotDescriptionPublisher() for _ in bodies]
    for publisher, body in zip(publishers, bodies.values()):
        publisher.configure(SimpleNamespace(node=thread.node, body=body))
    yield thread.node
    for publisher in publishers:
        publisher.unconfigure()
    thread.close()


@contextmanager
def going_on(*command, environment):
    """Run a command in the background, and stop its process group with Ctrl-C."""
    quiet = subprocess.DEVNULL
    process = subprocess.Popen([*REAL, *command], env=environment, stdout=quiet, stderr=quiet, start_new_session=True)
    try:
        yield process
    finally:
        os.killpg(process.pid, signal.SIGINT)
        process.wait(TIMEOUT)


def test_check_urdf_accepts_it(bodies, environment, tmp_path):
    for name, body in bodies.items():
        path = tmp_path / f"{name}.urdf"
        path.write_text(robot_description(body), encoding="utf-8")
        checked = subprocess.run(
            [*REAL, "check_urdf", path], env=environment, capture_output=True, text=True, check=False
        )
        assert checked.returncode == 0, checked.stderr
        assert f"robot name is: {name}" in checked.stdout
        assert "Successfully Parsed XML" in checked.stdout
        assert "rror" not in checked.stderr


def test_a_late_real_subscriber_gets_it(node, bodies, environment):
    echo = ["ros2", "topic", "echo", "--no-daemon", "--once", "--full-length", "--field", "data"]
    qos = ["--qos-reliability", "reliable", "--qos-durability", "transient_local"]
    command = [*REAL, *echo, *qos, "/Tank/robot_description", "std_msgs/msg/String"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=TIMEOUT, check=True)
    assert done.stdout.strip().removesuffix("---").strip() == robot_description(bodies["Tank"]).strip()


def test_robot_state_publisher_finds_every_link(node, bodies, environment):
    frames, kept = set(), QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)

    def hear(message):
        frames.update(each.child_frame_id for each in message.transforms)

    node.create_subscription(TFMessage, "/tf_static", hear, kept)
    node.create_subscription(TFMessage, "/tf", hear, 100)
    publishers = {name: node.create_publisher(JointState, f"{name}/joint_state", 1) for name in bodies}
    texts = {name: robot_description(body) for name, body in bodies.items()}
    links = {f"{name}/{link}" for name, text in texts.items() for link in re.findall('link name="(.*?)"', text)}
    stamps = count(1)

    def are_all_there():
        """Publish again with a new stamp: early messages may be lost, and a repeated stamp is ignored."""
        for name, body in bodies.items():
            message = JointState(name=list(body.joint_names), position=[0.1] * len(body.joint_names))
            message.header.stamp.sec = next(stamps)
            publishers[name].publish(message)
        return frames == links - {f"{name}/base_link" for name in NAMES}

    with ExitStack() as stack:
        for name, text in texts.items():
            program = ["ros2", "run", "robot_state_publisher", "robot_state_publisher", "--ros-args"]
            remapped = ["-r", f"__node:=its_{name}", "-r", f"joint_states:=/{name}/joint_state"]
            parameters = ["-p", f"frame_prefix:={name}/", "-p", f"robot_description:={text}"]
            stack.enter_context(going_on(*program, *remapped, *parameters, environment=environment))
        until(are_all_there, "a transform of every link")
