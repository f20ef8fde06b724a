"""The node that publishes for a fleet, as a program of its own, and a viewer that shows it."""

from __future__ import annotations

import asyncio
import signal
import subprocess
import sys
from dataclasses import replace

from programs import PATIENCE

from tutorial.host import Host
from tutorial.paths import HOME, find_project
from tutorial.project import Project


def test_every_tank_of_a_fleet_moves_until_ctrl_c(domain):
    project = Project.load(find_project("fleet"))
    fleet = replace(project, bodies=project.bodies[:3])

    async def scenario():
        async with Host(fleet) as host:
            turrets = [body.joint("TURRET_Y") for body in host.bodies.values()]
            async with asyncio.timeout(PATIENCE):
                while not all(turret.position for turret in turrets):
                    await asyncio.sleep(0.01)
            assert len({turret.position for turret in turrets}) == 3

    command = [sys.executable, "fleet.py", "3"]
    with subprocess.Popen(command, cwd=HOME / "notebooks", stderr=subprocess.PIPE, text=True) as publisher:
        try:
            asyncio.run(scenario())
        finally:
            publisher.send_signal(signal.SIGINT)
        assert "Traceback" not in publisher.stderr.read()
    assert publisher.returncode == 0
