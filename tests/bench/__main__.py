"""Measure costs as ratios: our code and a reference run alternately, so a noisy machine disturbs both equally.

``make bench`` runs it. It is not a test, because a person has to judge the ratios.
"""

import os
import shlex
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import tutorial  # noqa: F401 - makes rclpy importable

# isort: split
from cell_view import cell_frame
from costs import import_time, joint_matching, simulation_loop
from tables import console, show

from tutorial.ros.domains import reserved_domain

ROUNDS = 5
REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
"""A command that runs another command with a real ROS 2, if there is one."""


Pair = tuple[Callable[[], float], Callable[[], float]]


def measure(pair: Pair) -> list[float]:
    """Return the medians of our times and the reference's, measured alternately."""
    ours, reference = pair
    taken = [(ours(), reference()) for _ in range(ROUNDS)]
    return [statistics.median(each) for each in zip(*taken)]


def measured(program: str, *how: str, by: Sequence[str] = (), published_by: Sequence[str] | None = None) -> float:
    """Run ``program publish`` and ``program subscribe``, and return the number that the subscriber prints [s].

    Args:
        program: the file's name.
        how: further arguments for both.
        by: a command that runs both, such as `REAL`.
        published_by: a different command for the publisher; None uses the same one.
    """
    command = [sys.executable, str(Path(__file__).with_name(program))]
    publishing = [*(by if published_by is None else published_by), *command, "publish", *how]
    with (
        subprocess.Popen(publishing) as publisher,
        subprocess.Popen([*by, *command, "subscribe", *how], stdout=subprocess.PIPE, text=True) as subscriber,
    ):
        try:
            return float(subscriber.communicate(timeout=120)[0])
        finally:
            subscriber.kill()
            publisher.kill()


def traffic(pace: str, real: bool) -> Pair:
    """Measure our node and the reference: the real rclpy, flooded by the pocket one, or plain Cyclone DDS Python."""
    if real:
        reference = partial(measured, "traffic.py", "node", pace, by=REAL, published_by=REAL if pace == "beat" else ())
    else:
        reference = partial(measured, "traffic.py", "plain", pace)
    return partial(measured, "traffic.py", "node", pace), reference


def rows() -> Iterator[tuple[str, Pair, str, str]]:
    """Yield each row: its name, ours and the reference in seconds, the expected ratio, and the unit."""
    yield "simulation with controllers and publisher / bare mj_step, a step", simulation_loop(), "1.43", "us"
    yield "publish to callback / plain Cyclone DDS Python", traffic("beat", False), "1.2", "us"
    yield "from message to message, unthrottled / plain Cyclone DDS Python", traffic("flood", False), "2.2", "us"
    if REAL:
        yield "publish to callback / rclpy of a real ROS 2", traffic("beat", True), "0.82", "us"
        yield "from message to message, unthrottled / rclpy of a real ROS 2", traffic("flood", True), "0.2", "us"
        yield "processor time per received message / rclpy of a real ROS 2", traffic("cost", True), "0.2", "us"
    many, few = (partial(measured, "fleet.py", tanks) for tanks in ("100", "10"))
    yield "a viewer's processor time in 1 s for one tank at 50 Hz, of 100 / of 10", (many, few), "at most 1.0", "ms"
    if REAL:
        yield "the same, of 100 / with rclpy of a real ROS 2", (many, partial(many, by=REAL)), "", "ms"
    for joints in (2, 7, 40):
        yield f"joint matching / the original's index loop, {joints} joints", joint_matching(joints), "0.5", "us"
    yield "import tutorial / a Python that imports nothing", import_time(), "0.5 s", "ms"
    yield "a frame in a cell, everything moving / meshcat's own calls to its server", cell_frame(), "0.2", "us"


def main() -> None:
    """Measure everything and print the table."""
    made = []
    with reserved_domain() as domain:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        for name, pair, aim, unit in rows():
            console.print(f"measuring: {name} ...", style="dim")
            ours, reference = measure(pair)
            scale = {"us": 1e6, "ms": 1e3}[unit]
            figures = (f"{ours * scale:.2f} {unit}", f"{reference * scale:.2f} {unit}", f"{ours / reference:.2f}")
            made.append((name, *figures, aim))
    show(("", "ours", "reference", "ratio", "aim"), made)


if __name__ == "__main__":
    main()
