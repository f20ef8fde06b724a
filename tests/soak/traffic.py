"""Run one end of the traffic in a separate process: ``python traffic.py publish|subscribe|show|record KIND SECONDS``.

It uses only rclpy's public API, so it runs on any ROS 2. It prints its measurements as one line of JSON.
"""

import asyncio
import json
import statistics
import sys
import tempfile
import time
from array import array
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import tutorial  # noqa: F401 - makes rclpy importable

# isort: split
import numpy as np
import rclpy
from harness import Memory
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.ros.bags import Bag, Recorder
from tutorial.ros.node_thread import NodeThread
from tutorial.system.paths import find_project

RATE = 1000  # [Hz]
QUIET = 1.0  # [s] how long a silence has to last before no more messages are expected
TIMEOUT = 60.0  # [s] how long each end waits for the other end
TOPIC = "/Tank/joint_state"
QOS = {"best effort": qos_profile_sensor_data}
KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
"""No message replaces an older one: messages wait in the subscription until the callback is called, and a publisher
with too many unacknowledged messages has to wait. So even a busy machine loses nothing; the rate, the latency and the
memory show the delay instead. With a depth of N, messages would be lost once the callback is N messages behind: with
the usual 10, after 10 ms."""

memory = Memory()


def publish(kind: str, seconds: float) -> dict[str, Any]:
    """Send messages on a schedule; after a delay, catch up, so that no messages are lost and the rate is kept."""
    publisher = rclpy.create_node("publisher").create_publisher(JointState, TOPIC, QOS.get(kind, KEEP_ALL))
    joints = ["TURRET_Y", "TURRET_P"] if kind == "hand-off" else [f"JOINT_{i:02}" for i in range(40)]
    zeros = [0.0] * len(joints)
    message = JointState(name=joints, position=zeros, velocity=zeros, effort=zeros)
    count = round(seconds * RATE)
    while not publisher.get_subscription_count():
        time.sleep(0.01)
    began = time.monotonic()
    for i in range(count):
        time.sleep(max(0.0, began + i / RATE - time.monotonic()))
        message.header.frame_id = str(i)
        message.position[0] = 0.3 * i / count  # [rad]
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
        publisher.publish(message)
        memory.look()
    took = time.monotonic() - began
    publisher.wait_for_all_acked(Duration(seconds=TIMEOUT))
    return {"sent": count, "rate": count / max(took, count / RATE)}


def subscribe(kind: str, seconds: float) -> dict[str, Any]:
    """Count messages until the publisher has come and gone, and the topic is silent."""
    node = rclpy.create_node("subscriber")
    latencies = array("q", bytes(8 * round(seconds * RATE)))  # [ns], allocated in advance, so that it does not grow
    seen = disordered = 0
    newest = -1
    heard_at = time.monotonic()

    def callback(message: JointState) -> None:
        nonlocal seen, newest, disordered, heard_at
        stamp, heard_at = message.header.stamp, time.monotonic()
        latencies[seen] = time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec
        number = int(message.header.frame_id)
        disordered += number <= newest
        newest = number
        seen += 1
        memory.look()

    subscription = node.create_subscription(JointState, TOPIC, callback, QOS.get(kind, KEEP_ALL))
    with SingleThreadedExecutor() as executor:
        executor.add_node(node)
        while time.monotonic() < heard_at + QUIET:
            executor.spin_once(timeout_sec=0.1)
            if not seen or subscription.get_publisher_count():
                heard_at = time.monotonic()
    return {"received": seen, "disordered": disordered, **percentiles(latencies[:seen])}


async def show(kind: str, seconds: float) -> dict[str, Any]:
    """Run step 3's viewer like ``tank run step3 --headless``, and count the waiting calls."""
    waiting = [0]
    async with Host(Project.load(find_project("step3"))) as host:
        meter = next(meter for meter in host.node.meters if meter.topic == TOPIC)

        def look(_: float) -> None:
            if meter.count:
                waiting.append(host.waiting)
                memory.look()

        await host.run(seconds, 2 * seconds + TIMEOUT, look)
        record = host.record()
    counts = record["topics"][TOPIC]
    return {
        "received": counts["received"],
        "disordered": record["report"]["late"],
        **counts["latency_ms"],
        "applied": counts["applied"],
        "waiting": statistics.median(waiting[-(len(waiting) // 3 + 1) :]),
    }


def record(kind: str, seconds: float) -> dict[str, Any]:
    """Record a bag until the publisher has come and gone, like ``tank bag record``, and read it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "bag"
        with NodeThread("recorder") as thread, Recorder(thread.node, path, [TOPIC]) as recorder:
            while recorder.hears(TOPIC) or not recorder.counts.get(TOPIC):
                time.sleep(0.05)
                memory.look()
        messages = [(time_ns, message.header) for _, time_ns, message in Bag(path).messages()]
    numbers = [int(header.frame_id) for _, header in messages]
    latencies = [time_ns - Time.from_msg(header.stamp).nanoseconds for time_ns, header in messages]
    return {
        "received": len(numbers),
        "disordered": sum(later <= number for number, later in pairwise(numbers)),
        **percentiles(latencies),
    }


def percentiles(latencies: Sequence[int]) -> dict[str, float]:
    """Return the median and the worst hundredth [ms] of latencies [ns], or 0 if there are none."""
    median, p99 = np.percentile(latencies or [0], (50, 99)) / 1e6
    return {"median": median, "p99": p99}


if __name__ == "__main__":
    role, kind, seconds = sys.argv[1:]
    rclpy.init(args=[])
    try:
        if role == "show":
            result = asyncio.run(show(kind, float(seconds)))
        else:
            result = {"publish": publish, "subscribe": subscribe, "record": record}[role](kind, float(seconds))
    finally:
        rclpy.try_shutdown()
    print(json.dumps({**result, "grown": memory.growth()}))
