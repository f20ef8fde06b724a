"""Step 10's controller, on a real ROS 2: its services answer or refuse, and its gains are checked and used."""

import random

import numpy as np
import pytest
from loops import in_a_loop, until

pytest.importorskip("std_srvs.srv", reason="the pocket ROS 2 has no services: see make test-ros2")

from rclpy.parameter import Parameter
from std_srvs.srv import SetBool, Trigger

from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.ros.node_thread import NodeThread
from tutorial.system.paths import find_project

NAMES = {Trigger: "reset", SetBool: "set_motors"}
DEPTH = 10
"""The maximum number of requests in a service's queue. If there are more, the oldest is lost."""
NOT_RUNNING = (False, "the simulation is not running. Start it, and ask again.")


@pytest.fixture
def step10(domain):
    return Project.load(find_project("step10"))


class Client:
    """Another program that calls the tank's services."""

    def __init__(self, node):
        self.clients = {kind: node.create_client(kind, f"/Tank/{name}") for kind, name in NAMES.items()}

    async def send(self, kind, **fields):
        """Send a request, and return the future response."""
        await until(self.clients[kind].service_is_ready)
        return self.clients[kind].call_async(kind.Request(**fields))

    async def call(self, kind, **fields):
        response = await self.send(kind, **fields)
        await until(response.done)
        return response.result().success, response.result().message


@in_a_loop
async def test_reset_puts_the_tank_back_to_its_start(step10):
    async with Host(step10) as host:
        tank = host.simulation.bodies["Tank"]
        start = tank.qpos.copy()
        with NodeThread("client") as thread:
            client = Client(thread.node)
            assert await client.call(Trigger) == NOT_RUNNING
            tank.data.qpos[tank.qpos_slice.start] += 1.0  # it drives a metre
            tank.joint("TURRET_Y")._qpos[tank.joint("TURRET_Y").qpos_adr] = 1.0
            host.simulation.start()
            assert await client.call(Trigger) == (True, "Tank is back at its starting position")
            host.simulation.stop()
            assert await client.call(Trigger) == NOT_RUNNING
        assert np.abs(tank.qpos - start)[:7] == pytest.approx(np.zeros(7), abs=0.02)
        assert tank.joint("TURRET_Y").position == pytest.approx(0.0, abs=0.02), "and stays there"
        assert host.error is None


@in_a_loop
async def test_motors_can_be_switched_off_and_on(step10):
    async with Host(step10) as host:
        barrel = host.simulation.bodies["Tank"].joint("TURRET_P")
        with NodeThread("client") as thread:
            client = Client(thread.node)
            host.simulation.start()
            assert await client.call(SetBool, data=False) == (True, "the motors are off")
            await until(lambda: barrel.position < -0.15, "the barrel falls: -10 degrees is as low as it can go")
            assert await client.call(SetBool, data=True) == (True, "the motors are on")
            await until(lambda: barrel.position > -0.02, "the barrel is raised again")


def parameters(**values):
    return [Parameter(f"Tank.{name}", value=value) for name, value in values.items()]


@in_a_loop
async def test_gains_are_checked_and_used_from_the_next_step(step10):
    async with Host(step10) as host:
        node, controller = host.node, host.controllers["TankServer"]
        host.simulation.advance(1.0)
        at_rest = controller.barrel.joint.position
        out_of_range, both = parameters(p_gain=1000.1), parameters(p_gain=100.0, d_gain=10.0)
        assert "out of range" in node.set_parameters(out_of_range)[0].reason
        refused = node.set_parameters(both[1:])[0]
        assert (refused.successful, refused.reason) == (
            False,
            "with a p_gain of 200, a d_gain of 10 lets the turret swing: 11.7 is enough",
        )
        assert controller.gains.get() == {"Tank.p_gain": 200.0, "Tank.d_gain": 50.0}
        assert node.set_parameters_atomically([*both, Parameter("use_sim_time", value=False)]).successful
        assert controller.gains.get() == {"Tank.p_gain": 100.0, "Tank.d_gain": 10.0}
        host.simulation.advance(2.0)
        assert controller.barrel.joint.position == pytest.approx(2 * at_rest, rel=0.02), "half as stiff, it sags twice"
        described = node.describe_parameter("Tank.p_gain")
        assert described.description == "stiffness of turret and barrel [N.m/rad]"
        host.remove("Tank")
        assert not node.has_parameter("Tank.p_gain")
        await until(lambda: not [each for each, _ in node.get_service_names_and_types() if each.startswith("/Tank/")])


@in_a_loop
async def test_a_shutdown_leaves_nobody_waiting(step10, caplog):
    for seed in range(5):
        rng = random.Random(seed)
        with NodeThread("client") as thread:
            client = Client(thread.node)
            async with Host(step10) as host:
                host.simulation.start()
                assert (await client.call(Trigger))[0]
                asked = [await client.send(SetBool, data=rng.random() < 0.5) for _ in range(DEPTH)]
                some = asked[: rng.randrange(DEPTH)]
                await until(lambda some=some: all(each.done() for each in some))
            answered = [each.result().message for each in asked if each.done()]
        assert set(answered) <= {"the motors are on", "the motors are off", NOT_RUNNING[1]}
        assert host.error is None
    assert not caplog.messages
