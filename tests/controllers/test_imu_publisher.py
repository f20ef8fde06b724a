"""Step 4's controller: the measurements that the tank publishes."""

import numpy as np
import pytest
from controlled import on_course, stamps_ms

from tutorial.controller import SimpleController
from tutorial.controllers.imu_publisher import ImuPublisher
from tutorial.program.project import Project
from tutorial.system.paths import HOME


class Recorder(SimpleController):
    """Turns on the spot, and records the sensors before every step."""

    def initialize(self, io):
        self.sensors = io.body.sensor("ACCEL_SENSOR"), io.body.sensor("GYRO")
        io.body.actuator("TRACK_L").ctrl, io.body.actuator("TRACK_R").ctrl = -1.0, 1.0
        self.samples = []

    def control(self):
        self.samples.append([sensor.value for sensor in self.sensors])


@pytest.fixture
def tank():
    """The recorder, the messages, and the simulation."""
    recorder = Recorder()
    placements = [item.placement for item in Project.load(HOME / "project" / "step4.yaml").bodies]
    node, simulation = on_course(ImuPublisher(), placements, time_step=0.002, controllers=[recorder])
    return recorder, node.sent["Tank/imu"], simulation


def numbers(vector):
    return vector.x, vector.y, vector.z


def test_each_message_is_the_mean_since_the_previous_one(tank):
    recorder, sent, simulation = tank
    simulation.advance(1.002)
    samples = np.array(recorder.samples)
    assert stamps_ms(sent) == [50 * i for i in range(21)]
    for i, message in enumerate(sent[1:]):
        acceleration, velocity = samples[25 * i + 1 : 25 * i + 26].mean(axis=0)
        assert numbers(message.linear_acceleration) == pytest.approx(acceleration, abs=1e-12)
        assert numbers(message.angular_velocity) == pytest.approx(velocity, abs=1e-12)
    assert message.header.frame_id == "Tank/GYRO"
    o = message.orientation
    assert (o.x, o.y, o.z, o.w) == (0.0, 0.0, 0.0, 0.0), "the orientation is not measured"
    assert message.orientation_covariance.tolist() == [-1.0] + [0.0] * 8
    assert not message.linear_acceleration_covariance.any()
    assert not message.angular_velocity_covariance.any()


def test_it_restarts_with_the_simulation(tank):
    recorder, sent, simulation = tank
    simulation.advance(0.12)
    simulation.stop()
    before = len(sent)
    simulation.advance(0.032)
    assert stamps_ms(sent[before:]) == [150]
    acceleration, _ = np.array(recorder.samples).mean(axis=0)
    assert numbers(sent[-1].linear_acceleration) == pytest.approx(acceleration, abs=1e-12)
