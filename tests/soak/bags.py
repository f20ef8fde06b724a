"""A thousand joint states of 40 joints a second for a while, recorded by ``tank bag record``: whether one is missing.

``python tests/soak/bags.py [SECONDS] [mcap|sqlite3]`` runs it. The publisher is that of the other soaks: by its number,
each message that is missing in the bag is found.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
import click
import psutil
from domains import reserved_domain
from programs import TANK
from rich.console import Console
from run import GRACE, RATE_BOUND, one_end
from traffic import TOPIC
from verdict import judge

from tutorial.commands.terminal import progress_bar
from tutorial.ros.bags import Bag


def soak(seconds: float, storage: str, folder: Path, console: Console) -> list[str]:
    """Record; return what does not hold."""
    path = folder / "bag"
    before, began = psutil.cpu_times(), time.monotonic()
    recorder = subprocess.Popen([TANK, "bag", "record", TOPIC, "-s", storage, "-o", str(path)], process_group=0)
    try:
        with one_end("publish", "reliable", seconds) as publisher, progress_bar(seconds, shown=True) as progress:
            while publisher.poll() is None:
                progress(time.monotonic() - began)
                time.sleep(0.05)
            sent = json.loads(publisher.stdout.read().splitlines()[-1])
        memory = psutil.Process(recorder.pid).memory_info().rss / 2**20
        recorder.send_signal(signal.SIGINT)
        recorder.wait(GRACE)
    finally:
        recorder.kill()
    busy = sum(psutil.cpu_times()[:3]) - sum(before[:3])
    share = busy / (psutil.cpu_count() * (time.monotonic() - began))
    bag = Bag(path)
    numbers = [int(message.header.frame_id) for *_, message in bag.messages()]
    missing = sent["sent"] - len(set(numbers))
    console.print(
        f"{storage}: {sent['rate']:.1f} sent/s; {sent['sent']:,} sent, {len(numbers):,} in the bag, "
        f"{missing:,} missing; {bag.size / 2**20:.1f} MiB; {memory:.0f} MB of memory; "
        f"{psutil.cpu_count()} cores {share:.0%} busy, load {os.getloadavg()[0]:.1f}"
    )
    complaints = [f"{missing:,} messages are missing"] if missing else []
    if sent["rate"] < RATE_BOUND:
        complaints.append(f"{sent['rate']:.0f} messages a second were sent, at least {RATE_BOUND:.0f} are asked for")
    return complaints + (["they are out of order"] if numbers != sorted(numbers) else [])


@click.command(help=__doc__)
@click.argument("seconds", type=click.IntRange(1, 86_400), default=60)
@click.argument("storage", type=click.Choice(["mcap", "sqlite3"]), default="mcap")
def main(seconds: int, storage: str) -> None:
    """Do what the command line asks for, and exit with its status."""
    console = Console(width=None if sys.stdout.isatty() else 200)
    with reserved_domain() as domain, tempfile.TemporaryDirectory() as folder:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        sys.exit(judge(soak(seconds, storage, Path(folder), console), console))


if __name__ == "__main__":
    main()
