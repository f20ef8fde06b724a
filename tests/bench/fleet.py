"""What a fleet costs its viewer: the time of the processor for one tank's messages, at 50 Hz, of many tanks and of few.

Two processes: ``fleet.py publish COUNT`` publishes for so many tanks, one after the other and evenly; ``fleet.py show
COUNT`` is the viewer, with its view and without a browser.
"""

from __future__ import annotations

import asyncio
import math
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import count

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
import rclpy
from latency import REAL
from sensor_msgs.msg import JointState

from tutorial.host import Host
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.view.bodies import View
from tutorial.view.scene import Scene

RATE = 50  # [Hz], of each tank
WATCHED = 4.0  # [s]

Pair = tuple[Callable[[], float], Callable[[], float]]


def fleet(many: int = 100, few: int = 10) -> Pair:
    """Return ours and the reference: what the viewer computes for one tank of many, or of few, in a second [s]."""
    return lambda: one_of(many), lambda: one_of(few)


def real_fleet(many: int = 100) -> Pair:
    """As `fleet`, of many, beside the rclpy of a real ROS 2."""
    return lambda: one_of(many), lambda: one_of(many, by=REAL)


def one_of(tanks: int, by: Sequence[str] = ()) -> float:
    """Run a publisher and a viewer of so many tanks; by a command that runs others, if one is given."""
    command = [*by, sys.executable, __file__]
    with (
        subprocess.Popen([*command, "publish", str(tanks)]) as publisher,
        subprocess.Popen([*command, "show", str(tanks)], stdout=subprocess.PIPE, text=True) as viewer,
    ):
        try:
            return float(viewer.communicate(timeout=120)[0])
        finally:
            viewer.kill()
            publisher.kill()


def publish(tanks: int) -> None:
    """Let the turrets swing until this process is ended."""
    rclpy.init(args=[])
    node = rclpy.create_node("fleet")
    publishers = [node.create_publisher(JointState, f"/Tank_{i + 1}/joint_state", 1) for i in range(tanks)]
    message = JointState(name=["TURRET_Y", "TURRET_P"], velocity=[0.0, 0.0], effort=[0.0, 0.0])
    began = time.monotonic()
    for i in count():
        due = i / (RATE * tanks)
        time.sleep(max(0.0, began + due - time.monotonic()))
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(int(due * 1e9), 1_000_000_000)
        message.position = [math.sin(due + i % tanks), 0.1 * math.sin(3 * due)]
        publishers[i % tanks].publish(message)


def show(tanks: int) -> None:
    """Print what one tank's messages cost, once all tanks have been heard."""
    print(asyncio.run(_show(tanks)))


async def _show(tanks: int) -> float:
    project = Project.load(find_project("fleet"))
    async with Host(replace(project, bodies=project.bodies[:tanks]), view=View(Scene())) as host:
        running = asyncio.ensure_future(host.run())
        received = [meter for meter in host.node.meters if meter.direction == "received"]
        while not all(meter.count for meter in received):
            await asyncio.sleep(0.01)
        messages, computed = _applied(host), time.process_time()
        await asyncio.sleep(WATCHED)
        messages, computed = _applied(host) - messages, time.process_time() - computed
        running.cancel()
    return computed / messages * RATE


def _applied(host: Host) -> int:
    return sum(topic.get("applied", 0) for topic in host.record()["topics"].values())


if __name__ == "__main__":
    {"publish": publish, "show": show}[sys.argv[1]](int(sys.argv[2]))
