"""The commands ``tank bag``: what ``ros2 bag`` does, with the options that people know."""

# ruff: noqa: PLC0415 - rclpy takes a moment, and help is to come at once

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
from tutorial.system.printing import say

if TYPE_CHECKING:
    from tutorial.ros.bags import Bag, Recorder

LOOK_EVERY = 0.2  # [s] for how far a recording is
CLOCK_RATE = 40.0  # [Hz], as of ros2 bag

bag_argument = click.argument("bag", type=click.Path(path_type=Path), metavar="BAG")


@click.group("bag", short_help="Record topics, look at what was recorded, and play it again, as ros2 bag does.")
def bag() -> None:
    """Record topics into a bag, look at it, and play it again, as ros2 bag does."""


@bag.command(short_help="Record topics into a bag.")
@click.argument("topics", nargs=-1, metavar="[TOPICS]...")
@click.option("-a", "--all", "everything", is_flag=True, help="All topics, also those that appear later.")
@click.option("-o", "--output", type=Path, metavar="NAME", help="Its folder, a new one; else called after the time.")
@click.option("-s", "--storage", type=click.Choice(["mcap", "sqlite3"]), default="mcap", show_default=True)
@click.option(
    "-d", "--max-bag-duration", "longest", type=click.IntRange(1), metavar="SECONDS", help="A new file after so long."
)
@click.option("--use-sim-time", is_flag=True, help="Note the simulated time of receipt, from /clock.")
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
    """Record TOPICS, or with -a all of them, until Ctrl-C."""
    from tutorial.ros.bags import Recorder

    if bool(topics) == everything:
        raise click.UsageError("name topics, or give -a for all of them.")
    path = output or Path(time.strftime("rosbag2_%Y_%m_%d-%H_%M_%S"))
    stop = threading.Event()
    handle_signals(stop.set)
    with named_node("rosbag2_recorder", ros_args, use_sim_time) as thread:
        with clear_ros_errors():
            recorder = Recorder(thread.node, path, None if everything else topics, storage, longest or math.inf)
        with recorder, status_line() as status:
            say(f"recording into {path}; Ctrl-C ends it\n")
            while recorder.error is None and not stop.wait(LOOK_EVERY):
                status(_so_far(recorder))
    lost = f"; {recorder.lost:,} were lost" if recorder.lost else ""
    say(f"{_so_far(recorder)}{lost}\n")


@bag.command(short_help="Say what a bag holds.")
@bag_argument
def info(bag: Path) -> None:
    """Say what BAG holds: its length, and each topic with its type and the number of its messages."""
    from tutorial.ros.bags import Bag, bag_info

    opened = Bag(bag)
    say(bag_info(opened))
    _say_damage(opened)


@bag.command(short_help="Play a bag.")
@bag_argument
@click.argument("more", nargs=-1, metavar="")
@click.option("-r", "--rate", type=Finite(min=0, min_open=True), default=1.0, show_default=True, help="How fast.")
@click.option("-l", "--loop", is_flag=True, help="Begin anew at the end, until Ctrl-C.")
@click.option(
    "--clock",
    type=Finite(min=0, min_open=True, max=1000),  # as often as a simulation steps; far above, no message has its turn
    is_flag=False,
    flag_value=CLOCK_RATE,
    metavar="[HZ]",
    help=f"Publish the time of the bag on /clock, {CLOCK_RATE:g} times a second or as often as given.",
)
@click.option("--start-offset", type=Seconds(min=0), default=0.0, metavar="SECONDS", help="Leave so much out.")
@click.option("--topics", multiple=True, metavar="TOPIC...", help="Only those; all by default.")
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
    """Publish the messages of BAG again, byte for byte, at the times at which they were received."""
    from tutorial.ros.bags import Bag, Player

    if more and not topics:
        raise click.UsageError(f"{more[0]!r} is too much: one bag is played at a time. Topics stand after --topics.")
    opened = Bag(bag)
    stop = threading.Event()
    handle_signals(stop.set)
    with named_node("rosbag2_player", ros_args) as thread, clear_ros_errors():
        player = Player(thread.node, opened, rate, loop, start_offset, (*topics, *more) or None, clock or 0.0)
        say(f"playing {bag}, {opened.duration:.1f} s; Ctrl-C ends it\n")
        with progress_bar(opened.duration) as progress:
            player.run(stop, progress)
    say(f"{player.played:,} messages played\n")
    _say_damage(opened)
    return INTERRUPTED if stop.is_set() and not loop else 0


def _so_far(recorder: Recorder) -> str:
    count = sum(recorder.counts.values())
    return f"{count:,} messages of {len(recorder.counts):,} topics in {recorder.duration:.1f} s"


def _say_damage(bag: Bag) -> None:
    if bag.damage:
        say(f"{bag.damage}\n", err=True)
