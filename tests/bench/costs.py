"""What one step and one match cost. Each function returns ours and the reference, in seconds."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from tempfile import NamedTemporaryFile

import mujoco
from sensor_msgs.msg import JointState

from tutorial.body import Body
from tutorial.controller import ControllerConfig
from tutorial.controllers.joint_state_publisher import JointStatePublisher
from tutorial.controllers.tank_controller import TankController
from tutorial.joints import JointMatcher
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import Simulation
from tutorial.world import Placement

STEPS = 2000

Timed = Callable[[], float]


def timed(job: Callable[[], object], times: int) -> Timed:
    """Measure a job, and return how long one time takes [s]."""

    def run() -> float:
        began = time.perf_counter()
        for _ in range(times):
            job()
        return (time.perf_counter() - began) / times

    return run


def simulation_loop() -> tuple[Timed, Timed]:
    """A step of the tank in its laboratory, with both controllers and their topics; and `mj_step` alone."""
    placements = [item.placement for item in Project.load(find_project("step2")).bodies]
    node = NodeThread("bench").node
    controllers = []
    for controller in (TankController(), JointStatePublisher()):
        controller.configure(ControllerConfig(Body.displayed(placements[1]), node, print, print))
        controllers.append(("Tank", controller))
    simulation = Simulation(placements, controllers)
    bare = mujoco.MjData(simulation.model)

    def ours() -> float:
        return timed(lambda: simulation.advance(STEPS * simulation.time_step), 1)() / STEPS

    return ours, timed(lambda: mujoco.mj_step(simulation.model, bare), STEPS)


def joint_matching(count: int) -> tuple[Timed, Timed]:
    """Move a body's joints by one message, by name; and as the original does, by index."""
    body = chain(count)
    message = JointState(name=list(body.joint_names), position=[0.001 * i for i in range(count)])
    matcher = JointMatcher(body.joint_ranges)

    def by_name() -> None:
        positions, _ = matcher.match(message)
        body.set_joint_positions(positions)

    def by_index() -> None:
        for i in range(min(len(body.joints), len(message.name))):
            joint = body.joints[i]
            if joint.name == message.name[i]:
                joint.position = message.position[i]

    return timed(by_name, 20_000), timed(by_index, 20_000)


def chain(count: int) -> Body:
    """A robot with so many joints."""
    link = "<body><joint name='JOINT_{:02d}' range='-90 90'/><geom size='.1'/>"
    links = "".join(link.format(i) for i in range(count)) + "</body>" * count
    with NamedTemporaryFile("w", suffix=".xml") as file:
        file.write(f"<mujoco><worldbody>{links}</worldbody></mujoco>")
        file.flush()
        return Body.displayed(Placement("Chain", Path(file.name)))
