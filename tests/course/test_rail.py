"""The rail, from the joystick to the viewer: what the barrel meets in the simulation is seen in the other program.

Everything is real but the clock: the nodes talk over topics, and the simulation is advanced while they wait.
"""

from __future__ import annotations

import asyncio
from types import SimpleNamespace

import numpy as np
import pytest
from programs import until
from sensor_msgs.msg import Joy

from tutorial.body import Body
from tutorial.controller import ControllerConfig
from tutorial.controllers.joint_state_publisher import JointStatePublisher
from tutorial.controllers.joint_state_subscriber import JointStateSubscriber
from tutorial.controllers.tank_controller import TankController
from tutorial.handoff import CallQueue
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import Simulation


@pytest.fixture
def laboratory(domain):
    """The simulation of step 2 on a node of its own, and a joystick on another."""
    placements = [item.placement for item in Project.load(find_project("step2")).bodies]
    with NodeThread("simulation") as simulating, NodeThread("joystick") as driving:
        drive, publish = TankController(), JointStatePublisher()
        for controller in (drive, publish):
            controller.configure(ControllerConfig(Body.displayed(placements[1]), simulating.node, print, print))
        joystick = driving.node.create_publisher(Joy, "joy", 1)
        until(joystick.get_subscription_count, "the match")
        yield SimpleNamespace(
            simulation=Simulation(placements, [("Tank", drive), ("Tank", publish)]),
            joystick=joystick,
            axes=lambda: list(drive.joy.get().axes),
            published=publish.publisher.get_subscription_count,
        )


def contacts(simulation):
    """The pairs of geoms that touch."""
    names = [simulation.model.geom(i).name for i in range(simulation.model.ngeom)]
    return {frozenset(names[g] for g in pair) for pair in simulation.data.contact.geom}


def stamp_ns(message):
    return message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec


def tilt(simulation):
    """How far the chassis is from level [deg]."""
    up = simulation.data.body("Tank/CHASSIS").xmat[8]
    return np.degrees(np.arccos(np.clip(up, -1, 1)))


def test_driving_up_to_the_rail_moves_the_barrel_and_the_viewer_shows_it(laboratory):
    simulation, joystick = laboratory.simulation, laboratory.joystick

    async def watch():
        queue = CallQueue(asyncio.get_running_loop())
        scope = queue.scope("viewer")
        shown = Body.displayed(Project.load(find_project("step3")).bodies[0].placement)
        with NodeThread("viewer") as viewing:
            viewer = JointStateSubscriber()
            viewer.configure(ControllerConfig(shown, viewing.node, scope.call_later, scope.call_latest))
            until(laboratory.published, "the viewer")
            simulation.advance(1.0)
            at_rest = simulation.bodies["Tank"].joint("TURRET_P").position

            joystick.publish(Joy(axes=[0.0, 0.5, 0.0, 0.0]))  # ahead, and nothing for the turret
            until(lambda: laboratory.axes()[:2] == [0.0, 0.5], "the joystick")
            simulation.advance(5.5)

            barrel = simulation.bodies["Tank"].joint("TURRET_P").position
            assert frozenset(("Tank/BARREL", "Labo/RAIL")) in contacts(simulation)
            assert barrel - at_rest > 0.01
            assert tilt(simulation) < 5.0

            received = viewing.node.meters[0]
            until(
                lambda: received.last and stamp_ns(received.last) == 6_480_000_000,
                "the last message, 20 ms before 6.5 s",
            )
            sent = dict(zip(received.last.name, received.last.position))
            while shown.joint("TURRET_P").position != sent["TURRET_P"]:
                await asyncio.sleep(0.01)
            assert sent["TURRET_P"] - at_rest > 0.01
            assert shown.joint("TURRET_Y").position == sent["TURRET_Y"]

    asyncio.run(asyncio.wait_for(watch(), 90))
