"""Step 5's controller: what is measured is shown, and a blow shakes the body, which then stands where it stood."""

from __future__ import annotations

import asyncio
import math
from itertools import groupby

import numpy as np
import pytest
from controlled import Node, on_course
from loops import in_a_loop, until
from scenes import lines, raised_elsewhere
from sensor_msgs.msg import Imu, JointState, Joy

from tutorial.body import Body
from tutorial.checks._clock import ClockedLoop
from tutorial.controller import ControllerConfig
from tutorial.controllers.imu_publisher import ImuPublisher
from tutorial.controllers.imu_subscriber import ImuSubscriber, stand_at
from tutorial.controllers.tank_controller import TankController
from tutorial.errors import WrongThreadError
from tutorial.handoff import Latest
from tutorial.host import Host
from tutorial.paths import HOME, find_project
from tutorial.project import Project
from tutorial.ros.node_thread import NodeThread
from tutorial.view.bodies import View
from tutorial.view.scene import Scene
from tutorial.world import Placement

PLACE = (0.1 + 0.2, -1 / 3, 0.105)  # numbers that + and - do not bring back


def imu(x=0.0, y=0.0, z=9.8, turn=0.0):
    message = Imu()
    a, message.angular_velocity.z = message.linear_acceleration, turn
    a.x, a.y, a.z = x, y, z
    return message


class Viewer:
    """A controller on a displayed body, on an event loop whose clock stands still."""

    def __init__(self, model):
        self.loop, self.node = ClockedLoop(), Node()
        self.body = Body.displayed(Placement("Robot", HOME / "project" / "models" / f"{model}.xml", PLACE))
        self.places = []
        self.body.on_change(lambda _: self.places.append(self.body.data.xpos[1].tolist()))
        self.controller = ImuSubscriber()
        self.controller.configure(ControllerConfig(self.body, self.node, self.post, self.post))

    def post(self, function, *args):
        self.loop.within(lambda: function(*args))

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


def test_it_writes_down_what_is_measured(viewer):
    assert viewer.node.topics == ["Robot/imu"]
    assert viewer.hear(imu(1.0, 2.0, 3.0, turn=0.5))
    assert viewer.body.sensor("ACCEL_SENSOR").value.tolist() == [1.0, 2.0, 3.0]
    assert viewer.body.sensor("GYRO").value.tolist() == [0.0, 0.0, 0.5]
    assert len(viewer.places) == 1


@pytest.mark.parametrize("acceleration", [(20.0, 0.0), (-14.0, 14.0), (0.0, 0.0, 1e9), (math.nan, 3.0)])
def test_what_is_no_blow_does_not_shake(viewer, acceleration):
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
    assert len(off) in (25, 26)  # every 20 ms
    assert (abs(off) <= 0.02 + 1e-12).all()
    assert (abs(off).max(axis=0) > 0.01).all()


def test_a_new_blow_shakes_for_longer_about_the_same_place(viewer):
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
def test_when_it_leaves_there_is_no_timer_and_the_body_stands(viewer, blows):
    for _ in range(blows):
        viewer.hear(imu(30.0))
        viewer.loop.advance(0.0625)
    viewer.controller.unconfigure()
    assert viewer.node.topics == []
    assert not viewer.loop.timers
    assert viewer.body.position.tolist() == list(PLACE)
    assert not viewer.places or viewer.stands


class FullSpeed(TankController):
    """The stick is held ahead, and there is no node."""

    def __init__(self):
        self.joy = Latest(Joy(axes=[0.0, 1.0, 0.0, 0.0]))


def test_full_speed_into_the_wall_shakes_once_for_half_a_second():
    placements = [item.placement for item in Project.load(find_project("step1")).bodies]
    node, simulation = on_course(ImuPublisher(), placements, controllers=[FullSpeed()])
    simulation.advance(4.0)
    viewer, still = Viewer("tank"), []
    for message in node.sent["Tank/imu"]:
        viewer.hear(message)
        viewer.loop.advance(0.05)
        still.append(viewer.stands)
    viewer.loop.close()
    runs = [(stands, len(list(run))) for stands, run in groupby(still)]
    assert [stands for stands, _ in runs] == [True, False, True]
    assert runs[1][1] in (9, 10)  # 50 ms each; the first message of the next run is that after which it stands


@in_a_loop
async def test_deleted_while_it_shakes_it_leaves_no_timer_and_no_error(domain, caplog):
    """In a program, with messages from another node; joint states go on being shown meanwhile."""
    scene, handled = Scene(), []
    async with Host(Project.load(find_project("step5")), view=View(scene)) as host:
        body, loop = host.bodies["Tank"], asyncio.get_running_loop()
        place, shaker = body.position, host.controllers["ImuSubscriber"].shaker
        loop.set_exception_handler(lambda _, context: handled.append(context))
        with NodeThread("tester") as tester:
            blows = tester.node.create_publisher(Imu, "/Tank/imu", 1)
            joints = tester.node.create_publisher(JointState, "/Tank/joint_state", 1)
            await until(lambda: blows.get_subscription_count() and joints.get_subscription_count())
            blows.publish(imu(-30.0))
            await until(lambda: shaker.timer)
            joints.publish(JointState(name=["TURRET_Y"], position=[0.5]))
            await until(lambda: body.joint("TURRET_Y").position == 0.5)
            host.refresh()
            (line,) = lines(scene.snapshot())
            assert "1 joint shown" in line.splitlines()[0]
            assert "Tank\tacceleration\t-30.00\t0.00\t9.80\tm/s²\t" in line
            await until(lambda: shaker.timer is None)
            assert body.position.tolist() == place.tolist()
            blows.publish(imu(-30.0))
            await until(lambda: shaker.timer)
            host.remove("Tank")
            assert (shaker.timer, body.position.tolist()) == (None, place.tolist())
        assert (host.error, handled) == (None, [])
    assert not [record for record in caplog.records if record.levelname == "ERROR"]


def test_another_thread_may_not_shake_it(viewer):
    assert isinstance(raised_elsewhere(stand_at, viewer.body, np.zeros(3)), WrongThreadError)
