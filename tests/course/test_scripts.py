"""The notebooks' scripts as separate programs, which run until Ctrl-C."""

import asyncio
import signal
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import replace

import pytest
from loops import TIMEOUT, until

from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.system.paths import HOME, find_project

WITH_THE_COURSE = ["-c", "import tutorial; exec(open('listener.py').read())"]

pytestmark = pytest.mark.process


@contextmanager
def script(*arguments):
    """Run a script, and stop it with Ctrl-C, which must not print an error."""
    command = [sys.executable, *arguments]
    with subprocess.Popen(command, cwd=HOME / "notebooks", stderr=subprocess.PIPE, text=True) as running:
        try:
            yield running
        finally:
            running.send_signal(signal.SIGINT)
        assert "Traceback" not in running.stderr.read()
    assert running.returncode == 0


def test_every_tank_of_a_fleet_moves(domain):
    project = Project.load(find_project("fleet"))

    async def scenario():
        async with Host(replace(project, bodies=project.bodies[:3])) as host:
            turrets = [body.joint("TURRET_Y") for body in host.bodies.values()]
            await until(lambda: all(turret.position for turret in turrets))
            assert len({turret.position for turret in turrets}) == 3

    with script("fleet.py", "3"):
        asyncio.run(scenario())


LISTENER = "step2", "[listener]: TURRET_Y 0.00, TURRET_P -0.01\n"
FRAMES = "step7", "[frames]: the radar is 0.41 m above the floor\n"


@pytest.mark.parametrize(
    ("arguments", "project", "line"),
    [(["listener.py"], *LISTENER), (WITH_THE_COURSE, *LISTENER), (["frames.py"], *FRAMES)],
)
def test_a_node_without_the_course_logs_what_it_hears(domain, backend, arguments, project, line):
    if backend == "pocket" and arguments != WITH_THE_COURSE:
        pytest.skip("running it unchanged needs an installed ROS 2")

    async def scenario(node):
        async with Host(Project.load(find_project(project))) as host:
            running = asyncio.create_task(host.run())
            lines = iter(node.stderr.readline, "")
            assert await asyncio.to_thread(lambda: any(said.endswith(line) for said in lines))
            running.cancel()

    with script(*arguments) as node:
        asyncio.run(asyncio.wait_for(scenario(node), TIMEOUT))
