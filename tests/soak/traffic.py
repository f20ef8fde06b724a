"""One end of the traffic, in a process of its own: ``python traffic.py publish|subscribe|show KIND SECONDS``.

Only what rclpy promises is used, so it runs on any. What was measured is printed as one line of JSON. It stops early
when its standard input ends, which it also does when whoever started it is killed.
"""

from __future__ import annotations

import asyncio
import json
import os
import sys
import threading
import time
from array import array
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
import numpy as np
import rclpy
from memory import Memory, thirds
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import HistoryPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from sensor_msgs.msg import JointState

from tutorial.host import Host
from tutorial.paths import find_project
from tutorial.project import Project

RATE = 1000  # [Hz]
QUIET = 1.0  # [s] without a message, after which none is on its way any more
PATIENCE = 60.0  # [s] that one end waits for the other

KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, reliability=ReliabilityPolicy.RELIABLE)
"""Nothing is ever replaced by something newer: what the callback has not had yet waits with the subscription, and a
publisher with too much that is not acknowledged is made to wait. So nothing is lost however busy the machine is: that
shows in the rate, the latency and the memory instead. With a depth of N it would be lost once the callback is N
messages behind: at the usual 10, after 10 ms."""

QOS = {"reliable": KEEP_ALL, "best effort": qos_profile_sensor_data, "hand-off": KEEP_ALL}
JOINTS = {
    "reliable": tuple(f"JOINT_{i:02}" for i in range(40)),
    "best effort": tuple(f"JOINT_{i:02}" for i in range(40)),
    "hand-off": ("TURRET_Y", "TURRET_P"),
}
TOPIC = "/Tank/joint_state"

Result = dict[str, Any]


def publish(kind: str, seconds: float, stop: threading.Event) -> Result:
    """Send messages by a schedule: what is due is sent, so that a delay costs no message and no rate."""
    node = rclpy.create_node("publisher")
    publisher = node.create_publisher(JointState, TOPIC, QOS[kind])
    zeros = [0.0] * len(JOINTS[kind])
    message = JointState(name=list(JOINTS[kind]), position=zeros, velocity=zeros, effort=zeros)
    memory = Memory()
    count = round(seconds * RATE)
    while not publisher.get_subscription_count() and not stop.wait(0.01):
        pass
    began = time.monotonic()
    for i in range(count):
        if stop.wait(max(0.0, began + i / RATE - time.monotonic())):
            break
        message.header.frame_id = str(i)
        message.position[0] = 0.3 * i / count  # [rad]
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
        publisher.publish(message)
        if i % 10 == 0:
            memory.look()
    took = time.monotonic() - began
    go_on_unless(stop)
    publisher.wait_for_all_acked(Duration(seconds=PATIENCE))
    return {"sent": count, "rate": count / max(took, count / RATE), "memory": memory.trend()}


def subscribe(kind: str, seconds: float, stop: threading.Event) -> Result:
    """Count what arrives until the publisher has come and gone."""
    node = rclpy.create_node("subscriber")
    memory = Memory()
    latencies = array("q", bytes(8 * round(seconds * RATE)))  # [ns], there from the start: it is not to grow
    seen = disordered = 0
    newest = -1

    def callback(message: JointState) -> None:
        nonlocal seen, newest, disordered
        stamp = message.header.stamp
        latencies[seen] = time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec
        number = int(message.header.frame_id)
        disordered += number <= newest
        newest = number
        seen += 1
        memory.look()

    subscription = node.create_subscription(JointState, TOPIC, callback, QOS[kind])
    spin_until_over(node, lambda: seen, subscription.get_publisher_count, stop)
    go_on_unless(stop)
    median, p99 = np.percentile(latencies[:seen], (50, 99)) / 1e6
    return {"received": seen, "disordered": disordered, "median": median, "p99": p99, "memory": memory.trend()}


def spin_until_over(node: Node, count: Callable[[], int], publishers: Callable[[], int], stop: threading.Event) -> None:
    """Run callbacks until messages have come, their publisher has gone, and all is quiet."""
    last = time.monotonic()
    with SingleThreadedExecutor() as executor:
        executor.add_node(node)
        while not stop.is_set():
            before = count()
            executor.spin_once(timeout_sec=0.1)
            if count() > before or not before or publishers():
                last = time.monotonic()
            elif time.monotonic() - last > QUIET:
                return


def show(kind: str, seconds: float, stop: threading.Event) -> Result:
    """Be the viewer of step 3, as ``tank run step3 --headless`` is, and see how many posted calls wait."""
    return asyncio.run(_show(seconds, stop))


async def _show(seconds: float, stop: threading.Event) -> Result:
    memory = Memory()
    waiting: list[int] = []
    async with Host(Project.load(find_project("step3"))) as host:
        meter = next(meter for meter in host.node.meters if meter.topic == TOPIC)

        def look(_: float) -> None:
            if meter.count:
                waiting.append(host.waiting)
                memory.look()
            if stop.is_set():
                running.cancel()

        running = asyncio.ensure_future(host.run(seconds, 2 * seconds + PATIENCE, look))
        with suppress(asyncio.CancelledError):
            await running
        record = host.record()
    go_on_unless(stop)
    counts = record["topics"][TOPIC]
    return {
        "received": counts["received"],
        "disordered": record["report"]["late"],
        **counts["latency_ms"],
        "memory": memory.trend(),
        "applied": counts["applied"],
        "waiting": {"thirds": thirds(waiting), "most": max(waiting)},
    }


def go_on_unless(stop: threading.Event) -> None:
    """End the process, with nothing to say, if it was asked to stop."""
    if stop.is_set():
        sys.exit()


def end_of_input() -> threading.Event:
    """Return an event that is set when standard input ends."""
    ended = threading.Event()

    def read() -> None:
        os.read(0, 1)
        ended.set()

    threading.Thread(target=read, daemon=True).start()
    return ended


def main() -> None:
    """Be the end that the command line says."""
    role, kind, seconds = sys.argv[1:]
    stop = end_of_input()
    rclpy.init(args=[])
    try:
        result = {"publish": publish, "subscribe": subscribe, "show": show}[role](kind, float(seconds), stop)
    finally:
        rclpy.try_shutdown()
    print(json.dumps(result))


if __name__ == "__main__":
    main()
