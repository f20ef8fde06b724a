"""From publication to callback, between two processes: a node's callback, plain Cyclone DDS Python, and a real rclpy.

All publish the same message reliably: 100 times a second, with the time as a stamp in it; or as fast as they can, and
those that arrive are counted. A real rclpy gets its flood from the embedded one, which is the faster publisher.
"""

import os
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).parent
REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
"""A command that runs another one with a real ROS 2, where there is one."""

Pair = tuple[Callable[[], float], Callable[[], float]]


def latency() -> Pair:
    """Return ours and the reference: the median latency of one run [s]."""
    return lambda: between("node"), lambda: between("plain")


def throughput() -> Pair:
    """Return ours and the reference: the time from one message that arrives to the next, unthrottled [s]."""
    return lambda: between("node", "flood"), lambda: between("plain", "flood")


def real_latency() -> Pair:
    """As `latency`, beside the rclpy of a real ROS 2."""
    return lambda: between("node"), lambda: between("node", by=REAL)


def real_throughput() -> Pair:
    """As `throughput`, beside the rclpy of a real ROS 2."""
    return lambda: between("node", "flood"), lambda: between("node", "flood", by=REAL)


def real_cost() -> Pair:
    """As `real_throughput`, but the processor's time that a message takes the thread that spins."""
    return lambda: between("node", "cost"), lambda: between("node", "cost", by=REAL)


def between(kind: str, pace: str = "beat", by: list[str] | None = None) -> float:
    """Run a publisher and a subscriber in processes of their own; by a command that runs others, if one is given."""
    command = [sys.executable, str(HERE / f"{kind}_traffic.py"), pace]
    through = by or []
    with (
        subprocess.Popen([*(through if pace == "beat" else []), *command, "publish"]) as publisher,
        subprocess.Popen([*through, *command, "subscribe"], stdout=subprocess.PIPE, text=True) as subscriber,
    ):
        try:
            return float(subscriber.communicate(timeout=60)[0])
        finally:
            subscriber.kill()
            publisher.kill()
