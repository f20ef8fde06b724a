"""The referee: what it sees in the simulated world, and which manipulations it notices."""

import json
from contextlib import asynccontextmanager
from dataclasses import replace

import pytest
from loops import in_a_loop, until
from sensor_msgs.msg import Joy
from std_msgs.msg import String

from tutorial.controllers.referee import Referee
from tutorial.controllers.tank_controller import TankController
from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.race.rules import FINISHED
from tutorial.ros.node_thread import NodeThread
from tutorial.stepped_world import ControllerError
from tutorial.system.paths import original
from tutorial.view.bodies import View
from tutorial.view.scene import Scene

FORWARD = Joy(axes=[0.0, 1.0, 0.0, 0.0])


@pytest.fixture
def race(domain, tmp_path):
    """Open a race along a line of the test's own, with the tank at `start`, facing east."""

    @asynccontextmanager
    async def race(start, *points, view=None):
        line = tmp_path / "line.yaml"
        line.write_text(f"points: {list(map(list, points))}")
        project = Project.load(original() / "project" / "race.yaml").with_model("Line", line)
        *others, tank = project.with_controllers("Tank", TankController, Referee).bodies
        tank = replace(tank, placement=replace(tank.placement, position=(*start, 0.1)))
        async with Host(replace(project, bodies=(*others, tank)), view=view) as host:
            host.simulation.advance(0.001)
            yield host, host.controllers["Referee"].race

    return race


def drive(host, seconds, message=FORWARD):
    host.controllers["TankController"].joy.put(message)
    host.simulation.advance(seconds)


@in_a_loop
async def test_a_drive_to_the_rail_finishes_and_is_published_and_shown(race):
    scene = Scene()
    async with race((2.2, -0.5), (2.2, -0.5), (2.5, -0.5), view=View(scene)) as (host, judged):
        heard = []
        subscription = host.node.create_subscription(String, "/Tank/race", heard.append, 10)
        await until(subscription.get_publisher_count)
        drive(host, 0.3)
        host.simulation.stop()  # and it goes on
        drive(host, 0.4)
        assert (judged.result.progress, judged.result.end, judged.result.contacts) == (1.0, FINISHED, 0)
        await until(lambda: heard and json.loads(heard[-1].data) == judged.result.as_dict())
        await until(lambda: host.refresh() or b"rail touched: 100%" in scene.snapshot())


@in_a_loop
async def test_a_wall_is_a_contact(race):
    async with race((2.4, 1.0), (2.4, 1.0), (2.0, 1.0)) as (host, judged):
        drive(host, 0.5)
        assert (judged.result.contacts, judged.over) == (1, False)


@pytest.mark.parametrize(("message_type", "topic", "allowed"), [(Joy, "/joy", 1), (String, "/Tank/race", 0)])
@in_a_loop
async def test_a_second_publisher_is_a_foul(race, message_type, topic, allowed):
    with NodeThread("driver") as driver:
        async with race((0, 0), (0, 0), (1, 0)) as (host, judged):
            for count in range(allowed + 1):
                drive(host, 0.6, Joy())
                assert not judged.over
                driver.node.create_publisher(message_type, topic, 1)
                await until(lambda n=count + 2 - allowed: host.node.count_publishers(topic) == n)
            drive(host, 0.6, Joy())
            assert judged.result.foul == f"2 publishers on {topic}, not 1"


@pytest.mark.parametrize(
    ("act", "said"),
    [
        (lambda data: data.qpos.__setitem__(0, 0.9), "the tank has jumped 0.9"),
        (lambda data: data.qvel.__setitem__(0, 20.0), "the tank has jumped 0."),
        (lambda data: data.qfrc_applied.__setitem__(0, 5.0), "the tank is moved by something other than its motors"),
        (
            lambda data: data.xfrc_applied.__setitem__((-1, 0), 5.0),
            "the tank is moved by something other than its motors",
        ),
    ],
)
@in_a_loop
async def test_a_tank_that_its_motors_do_not_move_is_a_foul(race, act, said):
    async with race((0, 0), (0, 0), (1, 0)) as (host, judged):
        act(host.simulation.world.data)
        host.simulation.advance(0.02)
        assert judged.result.foul.startswith(said)


@in_a_loop
async def test_a_race_needs_a_line_that_begins_at_the_tank(race):
    with pytest.raises(
        ControllerError, match=r"more than 0\.3 m from the tank. Make it begin at the tank, at \[0\.00, 0\.00\]\."
    ):
        async with race((0, 0), (0.4, 0), (1, 0)):
            pass
