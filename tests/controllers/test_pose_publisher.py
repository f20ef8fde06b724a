"""Where the tank publishes that it is, and how it moves."""

from __future__ import annotations

from copy import copy
from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from tutorial.controller import SimpleController
from tutorial.controllers.pose_publisher import PosePublisher
from tutorial.paths import HOME, find_project
from tutorial.project import Project
from tutorial.simulation import Simulation
from tutorial.world import Placement


class Tracks(SimpleController):
    """A turn to the left while it drives."""

    def initialize(self, io):
        io.body.actuator("TRACK_L").ctrl, io.body.actuator("TRACK_R").ctrl = 0.5, 1.5


class Course:
    """A simulated body with a `PosePublisher`, and the messages that it has sent, by topic."""

    def __init__(self, placements, name="Tank", time_step=0.001, controllers=()):
        self.sent, self.types = {}, {}
        publisher = PosePublisher()
        publisher.configure(SimpleNamespace(node=self, body=SimpleNamespace(name=name)))
        every = [(name, each) for each in (*controllers, publisher)]
        self.simulation = Simulation(placements, every, time_step)

    def create_publisher(self, message_type, topic, depth):
        self.types[topic], self.sent[topic] = message_type, []
        return SimpleNamespace(publish=self.sent[topic].append)


def stamp_ns(message):
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def pose_of(message):
    p, q = message.pose.pose.position, message.pose.pose.orientation
    return np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z])


def twist_of(message):
    v, w = message.twist.twist.linear, message.twist.twist.angular
    return np.array([v.x, v.y, v.z]), np.array([w.x, w.y, w.z])


@pytest.fixture(scope="module")
def tank():
    placements = [item.placement for item in Project.load(find_project("step7")).bodies]
    course = Course(placements, controllers=[Tracks()])
    course.simulation.advance(1.001)
    return course


def test_it_says_50_times_a_second_what_the_snapshot_has(tank):
    messages = tank.sent["Tank/odom"]
    assert tank.types == {"/tf": TFMessage, "Tank/odom": Odometry}
    assert [stamp_ns(message) for message in messages] == [20_000_000 * i for i in range(51)]
    tank.simulation.advance(0.019)
    snapshot = tank.simulation.snapshot.get()
    tank.simulation.advance(0.001)
    assert stamp_ns(messages[-1]) / 1e9 == pytest.approx(snapshot.time, abs=1e-12)
    root = snapshot.qpos[tank.simulation.bodies["Tank"].qpos_slice][:7]
    assert np.concatenate(pose_of(messages[-1])).tolist() == root.tolist()


def test_the_transform_says_what_the_odometry_says(tank):
    for message, tf in zip(tank.sent["Tank/odom"], tank.sent["/tf"], strict=True):
        (transform,) = tf.transforms
        assert transform.header == message.header
        assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "Tank/base_link")
        assert message.child_frame_id == "Tank/base_link"
        t, p = transform.transform.translation, message.pose.pose.position
        assert (t.x, t.y, t.z) == (p.x, p.y, p.z)
        assert transform.transform.rotation == message.pose.pose.orientation


def test_its_velocity_is_what_mujoco_computes_for_the_root_in_its_own_frame(tank):
    simulation = tank.simulation
    simulation.advance((20 - simulation.step % 20) / 1000)
    data = copy(simulation.data)
    simulation.advance(0.001)
    mujoco.mj_forward(simulation.model, data)
    velocity, root = np.empty(6), simulation.model.body("Tank/CHASSIS").id
    mujoco.mj_objectVelocity(simulation.model, data, mujoco.mjtObj.mjOBJ_XBODY, root, velocity, 1)
    linear, angular = twist_of(tank.sent["Tank/odom"][-1])
    assert linear == pytest.approx(velocity[3:], abs=1e-9)
    assert angular == pytest.approx(velocity[:3], abs=1e-9)
    assert linear[0] > 0.5, "ahead"
    assert angular[2] > 0.2, "to the left"


def test_what_a_simulator_knows_exactly_has_no_variance(tank):
    message = tank.sent["Tank/odom"][-1]
    assert not np.any(message.pose.covariance)
    assert not np.any(message.twist.covariance)


def test_what_is_fixed_to_the_ground_is_published_too():
    crane = Course([Placement("Kran", HOME / "project" / "models" / "crane.xml", (1.0, 2.0, 0.5))], "Kran", 0.002)
    crane.simulation.advance(0.042)
    messages = crane.sent["Kran/odom"]
    assert [stamp_ns(message) for message in messages] == [0, 20_000_000, 40_000_000]
    assert pose_of(messages[-1])[0].tolist() == [1.0, 2.0, 0.5]
    assert pose_of(messages[-1])[1].tolist() == [1.0, 0.0, 0.0, 0.0]
    assert not np.any(twist_of(messages[-1]))
    assert messages[-1].child_frame_id == "Kran/base_link"
