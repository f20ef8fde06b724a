"""The parts of the page *Drive it*: its rclpy is the pocket ROS 2, and its physics is MuJoCo's."""

import json
import os
import shutil
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from behaviours import recorded
from controlled import Node
from sensor_msgs.msg import Joy

from tutorial.commands.joystick import ScriptedDrive
from tutorial.controllers.tank_controller import TankController
from tutorial.program.project import Project
from tutorial.simulation import Simulation
from tutorial.system.paths import HOME, find_drive, find_project

pytestmark = [pytest.mark.process, pytest.mark.timeout(300)]

SUPPORT = HOME / "tests/ros/pocket/support"


@pytest.fixture
def drive_page(monkeypatch):
    monkeypatch.syspath_prepend(HOME / "book")
    import drive_page

    return drive_page


BEHAVIOURS = """
import json, sys
from behaviours import outcome
import cyclonedds, rclpy
assert all(module.__file__.startswith(sys.argv[1]) for module in (cyclonedds, rclpy))
print(json.dumps([outcome(*snippet) for snippet in json.load(sys.stdin)]))
"""


def in_the_page(code, given, folder, domain):
    """Run code in a process that imports the page's modules. Return what it prints as JSON."""
    done = subprocess.run(
        [sys.executable, "-c", code, str(folder)],
        cwd=folder,
        input=json.dumps(given),
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(SUPPORT)]), "ROS_DOMAIN_ID": str(domain)},
        capture_output=True,
        text=True,
        check=False,
        timeout=280,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.pocket
def test_its_rclpy_behaves_like_a_real_one(drive_page, tmp_path, domain):
    drive_page.write_python(tmp_path)
    (tmp_path / "numpy.py").unlink()  # some snippets need the real numpy
    rows = recorded()
    found = in_the_page(BEHAVIOURS, [(row["prelude"], row["code"]) for row in rows], tmp_path, domain)
    for row, seen in zip(rows, found, strict=True):
        expected = {"printed": row["printed"], "raises": row.get("raises"), "logged": sorted(row.get("logged", ()))}
        assert seen == expected, row["code"]


RUN = """
import asyncio, json, sys
from types import SimpleNamespace
from unittest.mock import MagicMock
sys.modules["pyodide"] = sys.modules["pyodide.ffi"] = mujoco = MagicMock()
mujoco.MjModel.from_xml_string.return_value = SimpleNamespace(nq=0, nv=0, nu=0)
from page_program import Program

async def main():
    setup, lines = json.load(sys.stdin), []
    program = Program(mujoco, SimpleNamespace(to_py=lambda: setup), MagicMock(), lines.append)
    print(json.dumps([program.run(setup["source"]), lines]))

asyncio.run(main())
"""
MINE = """
from tutorial.controller import SimpleController
from tutorial.joints import JointReport

class Mine(SimpleController):
    def configure(self, config):
        config.body.notify_change()
        config.body.notify_change(JointReport())
"""


@pytest.mark.pocket
def test_a_change_without_a_message_keeps_the_line(drive_page, tmp_path, domain):
    drive_page.write_python(tmp_path)
    setup = {"node": "viewer", "simulates": False, "xml": "", "joints": [], "actuators": {}, "others": []}
    setup |= {"controller": "Mine", "file": str(tmp_path / "mine.py"), "source": MINE}
    assert in_the_page(RUN, setup, tmp_path, domain) == ["", ["0 joints shown"]]


def test_its_tank_drives_as_in_the_course(drive_page, tmp_path):
    node = shutil.which("node")
    if node is None or drive_page.fetch() is None:
        pytest.skip("without npm, the book does not have this page")
    drive_page.write_site(tmp_path)
    script = HOME / "tests/support/drive_without_page.mjs"
    tour = ScriptedDrive(find_drive("tour"))
    drive = [tour.read(5.5 + 0.02 * i)[0] for i in range(50)]  # a second in which it stops driving and aims
    done = subprocess.run(
        [node, script, tmp_path / "drive", json.dumps(drive)], capture_output=True, text=True, check=False, timeout=280
    )
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout)
    assert not seen["error"]

    controller = TankController()
    project = Project.load(find_project("step1"))
    controller.configure(SimpleNamespace(node=Node()))
    simulation = Simulation([each.placement for each in project.bodies], [("Tank", controller)])
    for axes in drive:
        controller.on_joy(Joy(axes=axes))
        simulation.advance(0.02)
    assert np.abs(simulation.world.data.qpos - seen["qpos"]).max() < 1e-6
    tank = simulation.bodies["Tank"]
    assert tank.position[0] < -2.2
    assert tank.joint("TURRET_Y").position < -0.5
