"""Step 7's publisher: the tank's pose and velocity."""

from copy import copy

import mujoco
import numpy as np
import pytest
from controlled import on_course, stamps_ms
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from tutorial.controller import SimpleController
from tutorial.controllers.pose_publisher import PosePublisher
from tutorial.program.project import Project
from tutorial.system.paths import find_project


class Tracks(SimpleController):
    """Drives and turns to the left."""

    def initialize(self, io):
        io.body.actuator("TRACK_L").ctrl, io.body.actuator("TRACK_R").ctrl = 0.5, 1.5


def test_it_publishes_pose_and_velocity_50_times_a_second():
    placements = [item.placement for item in Project.load(find_project("step7")).bodies]
    node, simulation = on_course(PosePublisher(), placements, time_step=0.002, controllers=[Tracks()])
    simulation.advance(1.02)
    data = copy(simulation.world.data)
    simulation.advance(0.002)
    assert node.types == {"/tf": TFMessage, "Tank/odom": Odometry}
    messages = node.sent["Tank/odom"]
    assert stamps_ms(messages) == [20 * i for i in range(52)]
    for message, tf in zip(messages, node.sent["/tf"], strict=True):
        (transform,) = tf.transforms
        assert (transform.header, transform.child_frame_id) == (message.header, message.child_frame_id)
        t, p = transform.transform.translation, message.pose.pose.position
        assert (t.x, t.y, t.z) == (p.x, p.y, p.z)
        assert transform.transform.rotation == message.pose.pose.orientation
    assert (message.header.frame_id, message.child_frame_id) == ("odom", "Tank/base_link")
    p, q = message.pose.pose.position, message.pose.pose.orientation
    assert [p.x, p.y, p.z, q.w, q.x, q.y, q.z] == data.qpos[simulation.bodies["Tank"].qpos_slice][:7].tolist()

    mujoco.mj_forward(simulation.model, data)
    expected, root = np.empty(6), simulation.model.body("Tank/CHASSIS").id
    mujoco.mj_objectVelocity(simulation.model, data, mujoco.mjtObj.mjOBJ_XBODY, root, expected, 1)
    v, w = message.twist.twist.linear, message.twist.twist.angular
    assert [w.x, w.y, w.z, v.x, v.y, v.z] == pytest.approx(expected, abs=1e-9)
    assert v.x > 0.5, "ahead"
    assert w.z > 0.2, "to the left"
    assert not np.any(message.pose.covariance), "a simulator knows it exactly"
    assert not np.any(message.twist.covariance)
