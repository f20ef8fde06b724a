"""Measure one step, one match, one import and one frame. Each function returns our time and the reference's [s]."""

import itertools
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import NamedTemporaryFile

import meshcat
import mujoco
import numpy as np
from sensor_msgs.msg import JointState

from tutorial.body import Body
from tutorial.controller import ControllerConfig
from tutorial.controllers.joint_state_publisher import JointStatePublisher
from tutorial.controllers.tank_controller import TankController
from tutorial.joints import JointMatcher
from tutorial.notebook.widgets.scene_view import SceneView
from tutorial.program.project import Project
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import Simulation
from tutorial.system.paths import HOME, find_project
from tutorial.view.bodies import View
from tutorial.view.scene import Scene
from tutorial.world import Placement

STEPS = 2000
TANK = Placement("Tank", HOME / "project" / "models" / "tank.xml")

Timed = Callable[[], float]


def timed(job: Callable[[], object], times: int) -> Timed:
    """Return a function that measures the time of one run of a job [s]."""

    def run() -> float:
        began = time.perf_counter()
        for _ in range(times):
            job()
        return (time.perf_counter() - began) / times

    return run


def simulation_loop() -> tuple[Timed, Timed]:
    """Measure a step of the tank in its laboratory, with both controllers and their topics; and `mj_step` alone."""
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
    """Measure moving a body's joints by one message, by name; and by index, as the original does."""
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
    """Return a robot with `count` joints."""
    link = "<body><joint name='JOINT_{:02d}' range='-90 90'/><geom size='.1'/>"
    links = "".join(link.format(i) for i in range(count)) + "</body>" * count
    with NamedTemporaryFile("w", suffix=".xml") as file:
        file.write(f"<mujoco><worldbody>{links}</worldbody></mujoco>")
        file.flush()
        return Body.displayed(Placement("Chain", Path(file.name)))


def import_time() -> tuple[Timed, Timed]:
    """Measure ``import tutorial`` in a fresh Python without Python's own start-up time; and the start-up time."""

    def start(code: str) -> float:
        began = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True)
        return time.perf_counter() - began

    return lambda: start("import tutorial") - start(""), lambda: start("")


def frame(address: str) -> tuple[Timed, Timed]:
    """Measure a frame in which the tank and all its wheels move; and the same with meshcat's own calls.

    Args:
        address: where meshcat sends its calls; ours go to a cell's page.
    """
    view = View(scene := Scene())
    body = Body.displayed(TANK)
    view.add("Tank", body.model)
    shown = SceneView(scene)
    shown._welcome("page")
    visualizer = meshcat.Visualizer(zmq_url=address)
    parts = [visualizer[str(i)] for i in range(body.model.nbody)]
    angles = itertools.count()

    def move() -> None:
        body.qpos[:] = 0.001 * next(angles)
        body.calc_forward_kinematics()

    def ours() -> None:
        move()
        view.update("Tank", body.data)
        view.flush()
        shown._note("page", shown.frame)

    def meshcats() -> None:
        move()
        matrix = np.eye(4)
        for i, part in enumerate(parts):
            matrix[:3, :3], matrix[:3, 3] = body.data.xmat[i].reshape(3, 3), body.data.xpos[i]
            part.set_transform(matrix)

    return timed(ours, 500), timed(meshcats, 500)
