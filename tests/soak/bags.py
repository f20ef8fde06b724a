"""A thousand joint states of 40 joints a second for a while, recorded by ``tank bag record``: whether one is missing.

The publisher is that of the other soaks: by its number, each message that is missing in the bag is found. ``make soak``
runs it, too.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
import psutil
from harness import GRACE, console, python, soak
from programs import TANK
from traffic import RATE, TOPIC

from tutorial.commands.terminal import progress_bar
from tutorial.ros.bags import Bag

TRAFFIC = Path(__file__).with_name("traffic.py")


def record(seconds: int, path: Path) -> tuple[dict[str, float], float]:
    """Record a bag of what is published meanwhile; return what the publisher said, and the recorder's memory [MB]."""
    recorder = subprocess.Popen([TANK, "bag", "record", TOPIC, "-o", str(path)], process_group=0)
    try:
        with (
            python(TRAFFIC, "publish", "reliable", seconds) as publisher,
            progress_bar(seconds, shown=True) as progress,
        ):
            began = time.monotonic()
            while publisher.poll() is None:
                progress(time.monotonic() - began)
                time.sleep(0.05)
            sent = json.loads(publisher.stdout.read().splitlines()[-1])
        memory = psutil.Process(recorder.pid).memory_info().rss / 1e6
        recorder.send_signal(signal.SIGINT)
        recorder.wait(GRACE)
    finally:
        recorder.kill()
    return sent, memory


def check(seconds: int, _: Sequence[str]) -> list[str]:
    """Hold a bag against what was sent; return what does not hold."""
    with tempfile.TemporaryDirectory() as folder:
        sent, memory = record(seconds, Path(folder) / "bag")
        bag = Bag(Path(folder) / "bag")
        numbers = [int(message.header.frame_id) for *_, message in bag.messages()]
        size = bag.size / 2**20
    missing = sent["sent"] - len(set(numbers))
    console.print(
        f"{sent['rate']:.1f} sent/s; {sent['sent']:,} sent, {len(numbers):,} in the bag, {missing:,} missing; "
        f"{size:.1f} MiB; {memory:.0f} MB of memory; {psutil.cpu_count()} cores, load {os.getloadavg()[0]:.1f}",
        soft_wrap=True,
    )
    found = [f"{missing:,} messages are missing"] if missing else []
    if sent["rate"] < 0.99 * RATE:
        found.append(f"{sent['rate']:.0f} messages a second were sent, at least {0.99 * RATE:.0f} are asked for")
    return found + (["they are out of order"] if numbers != sorted(numbers) else [])


if __name__ == "__main__":
    soak(__doc__, 60, ["mcap"], check)
