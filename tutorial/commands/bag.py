"""The ``tank bag`` commands, which work like those of ``ros2 bag`` and accept their most common options."""

# ruff: noqa: PLC0415 - rclpy is slow to import, and help must be fast

from __future__ import annotations

import math
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tutorial.commands.asking import clear_ros_errors, named_node
from tutorial.commands.options import Finite, Seconds
from tutorial.commands.terminal import INTERRUPTED, handle_signals, progress_bar, status_line
from tutorial.system.printing import print_text

if TYPE_CHECKING:
    from tutorial.ros.bags import Bag, Recorder

LOOK_EVERY = 0.2  # [s] between updates of a recording's status
CLOCK_RATE = 40.0  # [Hz], as in ros2 bag

bag_argument = click.argument("bag", type=click.Path(path_type=Path), metavar="BAG")


@click.group("bag", short_help="Record topics into bags, inspect bags, and play them, as ros2 bag does.")
def bag() -> None:
    """Record topics into bags, inspect bags, and play them, as ros2 bag does."""


@bag.command(short_help="Record topics into a bag.")
@click.argument("topics", nargs=-1, metavar="[TOPICS]...")
@click.option("-a", "--all", "everything", is_flag=True, help="Record all topics, including those that appear later.")
@click.option(
    "-o",
    "--output",
    type=Path,
    metavar="NAME",
    help="Record into this new folder; by default, into a folder named after the current time.",
)
@click.option("-s", "--storage", type=click.Choice(["mcap", "sqlite3"]), default="mcap", show_default=True)
@click.option(
    "-d",
    "--max-bag-duration",
    "longest",
    type=click.IntRange(1),
    metavar="SECONDS",
    help="Start a new file after this many seconds.",
)
@click.option("--use-sim-time", is_flag=True, help="Record the times of receipt in simulated time, from /clock.")
@click.pass_obj
def record(
    ros_args: list[str],
    /,
    topics: tuple[str, ...],
    everything: bool,
    output: Path | None,
    storage: str,
    longest: int | None,
    use_sim_time: bool,
) -> None:
    """Record TOPICS, or all topics with -a, until Ctrl-C."""
    from tutorial.ros.bags import Recorder

    if bool(topics) == everything:
        raise click.UsageError("name the topics, or give -a for all topics.")
    path = output or Path(time.strftime("rosbag2_%Y_%m_%d-%H_%M_%S"))
    stop = threading.Event()
    handle_signals(stop.set)
    with named_node("rosbag2_recorder", ros_args, use_sim_time) as thread:
        with clear_ros_errors():
            recorder = Recorder(thread.node, path, None if everything else topics, storage, longest or math.inf)
        with recorder, status_line() as status:
            print_text(f"recording into {path}; Ctrl-C stops it\n")
            while recorder.error is None and not stop.wait(LOOK_EVERY):
                status(_so_far(recorder))
    lost = f"; {recorder.lost:,} lost" if recorder.lost else ""
    print_text(f"{_so_far(recorder)}{lost}\n")


@bag.command(short_help="Show what a bag contains.")
@bag_argument
def info(bag: Path) -> None:
    """Show what BAG contains: its duration, and each topic with its type and number of messages."""
    from tutorial.ros.bags import Bag, bag_info

    opened = Bag(bag)
    print_text(bag_info(opened))
    _say_damage(opened)


@bag.command(short_help="Play a bag.")
@bag_argument
@click.argument("more", nargs=-1, metavar="")
@click.option(
    "-r", "--rate", type=Finite(min=0, min_open=True), default=1.0, show_default=True, help="Play at this speed."
)
@click.option("-l", "--loop", is_flag=True, help="Play the bag in a loop, until Ctrl-C.")
@click.option(
    "--clock",
    type=Finite(min=0, min_open=True, max=1000),  # a simulation's step rate; much higher rates delay the messages
    is_flag=False,
    flag_value=CLOCK_RATE,
    metavar="[HZ]",
    help=f"Publish the bag's time on /clock at this rate, or at {CLOCK_RATE:g} Hz if you give no rate.",
)
@click.option(
    "--start-offset", type=Seconds(min=0), default=0.0, metavar="SECONDS", help="Start this many seconds into the bag."
)
@click.option("--topics", multiple=True, metavar="TOPIC...", help="Play only these topics; by default, all topics.")
@click.pass_obj
def play(
    ros_args: list[str],
    /,
    bag: Path,
    more: tuple[str, ...],
    rate: float,
    loop: bool,
    clock: float | None,
    start_offset: float,
    topics: tuple[str, ...],
) -> int:
    """Publish the messages of BAG byte for byte, with their original timing."""
    from tutorial.ros.bags import Bag, Player

    if more and not topics:
        raise click.UsageError(f"{more[0]!r} is unexpected: give one bag, and list topics only after --topics.")
    opened = Bag(bag)
    stop = threading.Event()
    handle_signals(stop.set)
    with named_node("rosbag2_player", ros_args) as thread, clear_ros_errors():
        player = Player(thread.node, opened, rate, loop, start_offset, (*topics, *more) or None, clock or 0.0)
        print_text(f"playing {bag}, {opened.duration:.1f} s; Ctrl-C stops it\n")
        with progress_bar(opened.duration) as progress:
            player.run(stop, progress)
    print_text(f"{player.played:,} messages played\n")
    _say_damage(opened)
    return INTERRUPTED if stop.is_set() and not loop else 0


def _so_far(recorder: Recorder) -> str:
    count = sum(recorder.counts.values())
    return f"{count:,} messages of {len(recorder.counts):,} topics in {recorder.duration:.1f} s"


def _say_damage(bag: Bag) -> None:
    if bag.damage:
        print_text(f"{bag.damage}\n", err=True)
