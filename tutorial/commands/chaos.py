"""The command ``tank chaos``: a stream of joint states with deliberate faults."""

# ruff: noqa: PLC0415 - rclpy is slow to import, and help must be fast

import threading
from collections.abc import Sequence

import click

from tutorial.commands.asking import clear_ros_errors, named_node
from tutorial.commands.terminal import handle_signals
from tutorial.errors import TutorialError
from tutorial.ros.chaos import FAULTS, Chaos, parse_fault
from tutorial.system.printing import print_text

EPILOG = "\b\nThe faults:\n" + "\n".join(f"  {name:10} {what}" for name, what in FAULTS.items())


def _parse_faults(_ctx: click.Context, _param: click.Parameter, given: Sequence[str]) -> dict[str, float]:
    try:
        return dict(map(parse_fault, given))
    except TutorialError as error:
        raise click.BadParameter(str(error)) from None


@click.command(short_help="Publish joint states with deliberate faults, to test subscribers.", epilog=EPILOG)
@click.option(
    "-f",
    "--fault",
    "faults",
    multiple=True,
    callback=_parse_faults,
    metavar="FAULT[:SHARE]",
    help="Apply this fault to this share of the messages, from 0 to 1; by default, to all of them. Can be repeated.",
)
@click.option(
    "--from",
    "good",
    metavar="TOPIC",
    help="Read the correct messages from this topic, instead of generating a steady swing.",
)
@click.option(
    "--seed",
    type=int,
    default=0,
    show_default=True,
    help="Seed of the random number generator; the same seed always gives the same stream.",
)
@click.pass_obj
def chaos(ros_args: list[str], /, faults: dict[str, float], good: str | None, seed: int) -> None:
    """Publish joint states with deliberate faults on /Tank/joint_state, to test subscribers.

    Without -f, all messages are correct.
    """
    from tutorial.ros.chaos.stream import ChaosStream

    faulty = Chaos(faults, seed)
    stop = threading.Event()
    handle_signals(stop.set)
    with named_node("chaos", ros_args) as thread:
        with clear_ros_errors():
            ChaosStream(thread.node, faulty, good)
        shares = ", ".join(f"{name} {100 * share:g} %" for name, share in faults.items())
        print_text(f"{shares or 'no fault'}\n")
        stop.wait()
    hits = ", ".join(f"{name} {count}" for name, count in faulty.made.items() if count)
    print_text(f"affected messages: {hits or 'none'}\n")
