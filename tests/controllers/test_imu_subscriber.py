"""Step 5's controller: it shows the measurements, and a blow shakes the body, which returns to its place."""

import math

import numpy as np
import pytest
from controlled import Node
from sensor_msgs.msg import Imu

from tutorial.body import Body
from tutorial.checks.engine.clock import ClockedLoop
from tutorial.checks.engine.trial import Trial
from tutorial.controller import ControllerConfig
from tutorial.controllers.imu_subscriber import ImuSubscriber
from tutorial.system.paths import HOME
from tutorial.world import Placement

PLACE = (0.1 + 0.2, -1 / 3, 0.105)  # adding and subtracting an offset does not restore these numbers exactly


def imu(x=0.0, y=0.0, z=9.8, turn=0.0):
    message = Imu()
    a, message.angular_velocity.z = message.linear_acceleration, turn
    a.x, a.y, a.z = x, y, z
    return message


class Viewer:
    """A controller on a displayed body, on an event loop whose clock only the test moves."""

    def __init__(self, model):
        self.loop, self.node = ClockedLoop(Trial(ImuSubscriber)), Node()
        self.body = Body.displayed(Placement("Robot", HOME / "project" / "models" / f"{model}.xml", PLACE))
        self.places = []
        self.body.on_change(lambda _: self.places.append(self.body.data.xpos[1].tolist()))
        self.controller = ImuSubscriber()
        self.controller.configure(ControllerConfig(self.body, self.node, self.post, self.post))

    def post(self, function, *args):
        self.loop.call_soon(function, *args)
        self.loop.advance()

    def hear(self, message):
        self.controller.on_imu(message)
        return self.stands

    @property
    def stands(self):
        return self.places[-1] == self.body.position.tolist() == list(PLACE)


@pytest.fixture(params=["tank", "crane"])
def viewer(request):
    viewer = Viewer(request.param)
    yield viewer
    viewer.loop.close()


def test_it_shows_the_measurements(viewer):
    assert viewer.node.topics == ["Robot/imu"]
    assert viewer.hear(imu(1.0, 2.0, 3.0, turn=0.5))
    assert viewer.body.sensor("ACCEL_SENSOR").value.tolist() == [1.0, 2.0, 3.0]
    assert viewer.body.sensor("GYRO").value.tolist() == [0.0, 0.0, 0.5]
    assert len(viewer.places) == 1


@pytest.mark.parametrize("acceleration", [(20.0, 0.0), (-14.0, 14.0), (0.0, 0.0, 1e9), (math.nan, 3.0)])
def test_weak_accelerations_do_not_shake(viewer, acceleration):
    assert viewer.hear(imu(*acceleration))
    assert not viewer.loop.timers


@pytest.mark.parametrize("acceleration", [(20.01, 0.0), (0.0, -20.01), (-15.0, 15.0), (math.inf, 0.0)])
def test_a_blow_shakes_for_half_a_second(viewer, acceleration):
    assert not viewer.hear(imu(*acceleration))
    viewer.loop.advance(0.499)
    assert not viewer.stands
    viewer.loop.advance(0.021)
    assert viewer.stands
    assert not viewer.loop.timers
    off = np.array(viewer.places[1:-1]) - PLACE
    assert len(off) in (25, 26)  # one every 20 ms
    assert (abs(off) <= 0.02 + 1e-12).all()
    assert (abs(off).max(axis=0) > 0.01).all()


def test_a_second_blow_prolongs_the_shake_around_the_same_place(viewer):
    viewer.hear(imu(30.0))
    viewer.loop.advance(0.375)
    viewer.hear(imu(0.0, 30.0))
    assert len(viewer.loop.timers) == 1
    viewer.loop.advance(0.4375)
    assert not viewer.stands
    viewer.loop.advance(0.125)
    assert viewer.stands
    assert (abs(np.array(viewer.places) - PLACE) <= 0.02 + 1e-12).all()


@pytest.mark.parametrize("blows", [0, 1, 2])
def test_leaving_cancels_the_timer_and_restores_the_body(viewer, blows):
    for _ in range(blows):
        viewer.hear(imu(30.0))
        viewer.loop.advance(0.0625)
    viewer.controller.unconfigure()
    assert viewer.node.topics == []
    assert not viewer.loop.timers
    assert viewer.body.position.tolist() == list(PLACE)
    assert not viewer.places or viewer.stands
