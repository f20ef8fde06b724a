"""Measure what a fleet costs its viewer: the processor time for one tank's messages at 50 Hz, with few and many tanks.

Two processes: ``fleet.py publish COUNT`` publishes for `COUNT` tanks at evenly spaced times; ``fleet.py
subscribe COUNT`` is the viewer, with its view but without a browser.
"""

import asyncio
import math
import sys
import time
from dataclasses import replace
from itertools import count

import tutorial  # noqa: F401 - makes rclpy importable

# isort: split
import rclpy
from sensor_msgs.msg import JointState

from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.system.paths import find_project
from tutorial.view.bodies import View
from tutorial.view.scene import Scene

RATE = 50  # [Hz], for each tank
WATCHED = 4.0  # [s]


def publish(tanks: int) -> None:
    """Swing the turrets until this process exits."""
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


async def show(tanks: int) -> float:
    """Return the processor time of one tank's messages per second, once every tank has sent a message [s]."""
    project = Project.load(find_project("fleet"))
    view = View(scene := Scene())
    scene.attach(len)
    async with Host(replace(project, bodies=project.bodies[:tanks]), view=view) as host:
        running = asyncio.ensure_future(host.run())
        received = [meter for meter in host.node.meters if meter.direction == "received"]
        while not all(meter.count for meter in received):
            await asyncio.sleep(0.01)
        messages, computed = applied(host), time.process_time()
        await asyncio.sleep(WATCHED)
        messages, computed = applied(host) - messages, time.process_time() - computed
        running.cancel()
    return computed / messages * RATE


def applied(host: Host) -> int:
    """Return the number of applied messages."""
    return sum(topic.get("applied", 0) for topic in host.record()["topics"].values())


if __name__ == "__main__":
    tanks = int(sys.argv[2])
    print(publish(tanks) if sys.argv[1] == "publish" else asyncio.run(show(tanks)))
