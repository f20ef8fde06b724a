"""Where the tank publishes that it is, and how it moves."""

from __future__ import annotations

from copy import copy

import mujoco
import numpy as np
import pytest
from controlled import on_course, stamps_ms
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from tutorial.controller import SimpleController
from tutorial.controllers.pose_publisher import PosePublisher
from tutorial.paths import HOME, find_project
from tutorial.project import Project
from tutorial.world import Placement


class Tracks(SimpleController):
    """A turn to the left while it drives."""

    def initialize(self, io):
        io.body.actuator("TRACK_L").ctrl, io.body.actuator("TRACK_R").ctrl = 0.5, 1.5


def pose_of(message):
    p, q = message.pose.pose.position, message.pose.pose.orientation
    return np.array([p.x, p.y, p.z]), np.array([q.w, q.x, q.y, q.z])


def twist_of(message):
    v, w = message.twist.twist.linear, message.twist.twist.angular
    return np.array([v.x, v.y, v.z]), np.array([w.x, w.y, w.z])


@pytest.fixture(scope="module")
def tank():
    placements = [item.placement for item in Project.load(find_project("step7")).bodies]
    node, simulation = on_course(PosePublisher(), placements, controllers=[Tracks()])
    simulation.advance(1.001)
    return node, simulation


def test_it_says_50_times_a_second_twice_what_the_snapshot_has(tank):
    node, simulation = tank
    messages = node.sent["Tank/odom"]
    assert node.types == {"/tf": TFMessage, "Tank/odom": Odometry}
    assert stamps_ms(messages) == [20 * i for i in range(51)]
    simulation.advance(0.019)
    snapshot = simulation.snapshot.get()
    simulation.advance(0.001)
    assert stamps_ms(messages)[-1] / 1e3 == pytest.approx(snapshot.time, abs=1e-12)
    root = snapshot.qpos[simulation.bodies["Tank"].qpos_slice][:7]
    assert np.concatenate(pose_of(messages[-1])).tolist() == root.tolist()
    assert (messages[-1].header.frame_id, messages[-1].child_frame_id) == ("odom", "Tank/base_link")
    for message, tf in zip(messages, node.sent["/tf"], strict=True):
        (transform,) = tf.transforms
        assert (transform.header, transform.child_frame_id) == (message.header, message.child_frame_id)
        t, p = transform.transform.translation, message.pose.pose.position
        assert (t.x, t.y, t.z) == (p.x, p.y, p.z)
        assert transform.transform.rotation == message.pose.pose.orientation


def test_its_velocity_is_what_mujoco_computes_for_the_root_in_its_own_frame(tank):
    node, simulation = tank
    simulation.advance((20 - simulation.step % 20) / 1000)
    data = copy(simulation.data)
    simulation.advance(0.001)
    mujoco.mj_forward(simulation.model, data)
    velocity, root = np.empty(6), simulation.model.body("Tank/CHASSIS").id
    mujoco.mj_objectVelocity(simulation.model, data, mujoco.mjtObj.mjOBJ_XBODY, root, velocity, 1)
    message = node.sent["Tank/odom"][-1]
    linear, angular = twist_of(message)
    assert linear == pytest.approx(velocity[3:], abs=1e-9)
    assert angular == pytest.approx(velocity[:3], abs=1e-9)
    assert linear[0] > 0.5, "ahead"
    assert angular[2] > 0.2, "to the left"
    assert not np.any(message.pose.covariance), "a simulator knows it exactly"
    assert not np.any(message.twist.covariance)


def test_what_is_fixed_to_the_ground_is_published_too():
    crane = Placement("Kran", HOME / "project" / "models" / "crane.xml", (1.0, 2.0, 0.5))
    node, simulation = on_course(PosePublisher(), [crane], "Kran", 0.002)
    simulation.advance(0.042)
    messages = node.sent["Kran/odom"]
    assert stamps_ms(messages) == [0, 20, 40]
    assert np.concatenate(pose_of(messages[-1])).tolist() == [1.0, 2.0, 0.5, 1.0, 0.0, 0.0, 0.0]
    assert not np.any(twist_of(messages[-1]))
    assert messages[-1].child_frame_id == "Kran/base_link"
