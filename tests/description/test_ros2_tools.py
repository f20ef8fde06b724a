"""What the tools of a real ROS 2 make of the robot description. They run where TANK_REAL_ROS2 says.

As in ``tests/ros/test_beside_ros2.py`` it names a command that runs another with ROS 2. RMW_IMPLEMENTATION says which
middleware that has, Cyclone DDS if it is not set.
"""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
from collections import defaultdict
from contextlib import ExitStack, contextmanager
from itertools import count, islice
from types import SimpleNamespace

import numpy as np
import pytest
from programs import PATIENCE, until
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from tutorial.body import Body
from tutorial.controllers.robot_description_publisher import RobotDescriptionPublisher
from tutorial.description.poses import pose
from tutorial.description.urdf import robot_description
from tutorial.paths import HOME
from tutorial.ros.domains import reserved_domain
from tutorial.ros.node_thread import NodeThread
from tutorial.world import Placement

REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
RMW = os.environ.get("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")
MODELS = HOME / "project" / "models"
NAMES = ("Tank", "Crane")

pytestmark = [pytest.mark.ros2, pytest.mark.timeout(300)]
if not REAL:
    pytest.skip("TANK_REAL_ROS2 is not set: it names a command that runs another with ROS 2", allow_module_level=True)


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
    """The node of a program of the pocket ROS 2, which publishes both descriptions."""
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
    """A command that goes on, until Ctrl-C ends it and what it is run by."""
    quiet = subprocess.DEVNULL
    process = subprocess.Popen([*REAL, *command], env=environment, stdout=quiet, stderr=quiet, start_new_session=True)
    try:
        yield process
    finally:
        os.killpg(process.pid, signal.SIGINT)
        process.wait(PATIENCE)


class Transforms:
    """All transforms that were published.

    Attributes:
        fixed: parent and pose by child, of ``/tf_static``.
        moving: likewise of ``/tf``, by stamp [s].
    """

    def __init__(self, node):
        self.fixed, self.moving = {}, defaultdict(dict)
        kept = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.subscriptions = [
            node.create_subscription(TFMessage, "/tf_static", lambda message: self.take(message, False), kept),
            node.create_subscription(TFMessage, "/tf", lambda message: self.take(message, True), 100),
        ]

    def take(self, message, moves):
        for each in message.transforms:
            place, turned = each.transform.translation, each.transform.rotation
            found = pose((place.x, place.y, place.z), (turned.w, turned.x, turned.y, turned.z))
            known = self.moving[each.header.stamp.sec] if moves else self.fixed
            known[each.child_frame_id] = each.header.frame_id, found

    def pose(self, frame, stamp):
        """Where a frame is in the root of its tree, 4 x 4; None while that is not known."""
        found = np.eye(4)
        known = {**self.fixed, **self.moving[stamp]}
        while not frame.endswith("/base_link"):
            if frame not in known:
                return None
            frame, matrix = known[frame]
            found = matrix @ found
        return found


def test_check_urdf_has_nothing_to_say_against_it(bodies, environment, tmp_path):
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


def test_a_real_latecomer_gets_it(node, bodies, environment):
    echo = ["ros2", "topic", "echo", "--no-daemon", "--once", "--full-length", "--field", "data"]
    qos = ["--qos-reliability", "reliable", "--qos-durability", "transient_local"]
    command = [*REAL, *echo, *qos, "/Tank/robot_description", "std_msgs/msg/String"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=PATIENCE, check=True)
    assert done.stdout.strip().removesuffix("---").strip() == robot_description(bodies["Tank"]).strip()


def test_robot_state_publisher_has_every_link_where_mujoco_has_it(node, bodies, environment):
    transforms, generator = Transforms(node), np.random.default_rng(17)
    publishers = {name: node.create_publisher(JointState, f"{name}/joint_state", 1) for name in bodies}
    with ExitStack() as stack:
        for name, body in bodies.items():
            program = ["ros2", "run", "robot_state_publisher", "robot_state_publisher", "--ros-args"]
            remapped = ["-r", f"__node:=its_{name}", "-r", f"joint_states:=/{name}/joint_state"]
            parameters = ["-p", f"frame_prefix:={name}/", "-p", f"robot_description:={robot_description(body)}"]
            stack.enter_context(going_on(*program, *remapped, *parameters, environment=environment))
        until(lambda: all(each.get_subscription_count() for each in publishers.values()), "the joints' subscribers")
        until(lambda: {frame.split("/")[0] for frame in transforms.fixed} == set(NAMES), "what does not move")
        stamps = count(1)  # [s]

        def moves():
            """Its ends are met one after the other: what is published before all of them are is lost."""
            stamp = next(stamps)
            for name, body in bodies.items():
                publish(publishers[name], body, generator, stamp)
            moving = {frame.split("/")[0] for frames in list(transforms.moving.values()) for frame in list(frames)}
            return moving == set(NAMES)

        until(moves, "what moves")
        for stamp in islice(stamps, 100):
            for name, body in bodies.items():
                publish(publishers[name], body, generator, stamp)
            for body in bodies.values():
                assert_same_places(transforms, body, stamp)


def publish(publisher, body, generator, stamp):
    """Move a body's joints somewhere within their ranges, and publish where they are."""
    body.set_joint_positions({name: generator.uniform(*ends) for name, ends in body.joint_ranges.items()})
    body.calc_forward_kinematics()
    message = JointState(name=list(body.joint_names), position=[joint.position for joint in body.joints])
    message.header.stamp.sec = stamp
    publisher.publish(message)


def assert_same_places(transforms, body, stamp):
    model, data = body.model, body.data
    root = pose(data.xpos[1], data.xquat[1])
    for number in range(1, model.nbody):
        name = model.body(number).name
        frame = f"{name}_link" if name.partition("/")[2] in body.joint_names else name
        until(lambda f=frame: transforms.pose(f, stamp) is not None, f"a transform of {frame}")
        expected = pose(data.xpos[number], data.xquat[number])
        np.testing.assert_allclose(root @ transforms.pose(frame, stamp), expected, atol=1e-6, err_msg=frame)
