"""The command ``tank chaos``: a good stream of joint states with faults in it."""

# ruff: noqa: PLC0415 - rclpy takes a moment, and help is to come at once

from __future__ import annotations

import threading
from collections.abc import Mapping
from contextlib import closing
from typing import Any

import click

from tutorial.commands.asking import named_node
from tutorial.commands.options import duration_option
from tutorial.commands.terminal import INTERRUPTED, handle_signals, progress_bar, say
from tutorial.errors import TutorialError
from tutorial.ros.chaos import FAULTS, Chaos, parse_fault, share_of

__all__ = ["chaos"]

LOOK = 0.1  # [s] between two looks at how far the stream has come
EPILOG = "\b\nThe faults:\n" + "\n".join(f"  {name:10} {what}" for name, what in FAULTS.items())


class FaultType(click.ParamType):  # type: ignore[type-arg]
    """A fault, and which share of the messages it hits."""

    name = "fault"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, float]:
        """Read it, or say what is wrong."""
        if isinstance(value, tuple):
            return value
        try:
            return parse_fault(value)
        except TutorialError as error:
            self.fail(str(error), param, ctx)


@click.command(short_help="Publish joint states with faults in them, and see who can bear it.", epilog=EPILOG)
@click.argument("topic_name", default="/Tank/joint_state")
@click.option(
    "-f",
    "--fault",
    "faults",
    multiple=True,
    type=FaultType(),
    metavar="FAULT[:SHARE]",
    help="Put this fault into that share of the messages, 0 to 1; without a share, into all. May be repeated.",
)
@click.option(
    "--from", "good", metavar="TOPIC", help="Take the good messages from this topic, in place of a steady swing."
)
@click.option("--seed", type=int, default=0, show_default=True, help="The same seed gives the same stream again.")
@duration_option
@click.pass_obj
def chaos(
    ros_args: list[str],
    /,
    topic_name: str,
    faults: tuple[tuple[str, float], ...],
    good: str | None,
    seed: int,
    duration: float | None,
) -> int:
    """Publish joint states with faults on TOPIC_NAME, by default /Tank/joint_state: who listens, and can bear it?

    Without any fault it is a good stream.
    """
    from tutorial.commands.asking import clear_ros_errors
    from tutorial.ros.chaos.stream import ChaosStream

    faulty = Chaos(dict(faults), seed)
    stop = threading.Event()
    handle_signals(stop.set)
    with named_node("chaos", ros_args) as thread:
        with clear_ros_errors():
            stream = ChaosStream(thread.node, faulty, topic_name, good)
        say(f"{_words(faulty.faults)}\n")
        with closing(stream), progress_bar(duration) as progress:
            while not stop.wait(LOOK) and (duration is None or stream.seconds < duration):
                progress(stream.seconds)
            progress(stream.seconds)
    say(f"{_summary(faulty.made)}\n")
    return INTERRUPTED if stop.is_set() and duration is not None else 0


def _words(faults: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {share_of(share)}" for name, share in faults.items()) or "no fault"


def _summary(made: Mapping[str, int]) -> str:
    """How many messages each fault has hit."""
    return "messages hit: " + (", ".join(f"{name} {count}" for name, count in made.items() if count) or "none")
