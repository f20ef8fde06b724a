"""A thousand messages a second for a while, between two processes: what is lost, how late it is, and whether memory
stays flat; then the same into the viewer of step 3, whose queue must not grow; then hostile joint states.

``make soak`` runs it. Its exit status is 1 if something does not hold; below the tables it says what.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
import click
from domains import reserved_domain
from hostile import hostile
from memory import WARM_UP
from rich.console import Console
from rich.table import Table
from run import Outcome, run
from verdict import judge

from tutorial.commands.terminal import INTERRUPTED, progress_bar

KINDS = {"reliable": "subscribe", "best effort": "subscribe", "hand-off": "show"}
HOSTILE = "hostile"


def table_of_messages(outcomes: list[Outcome]) -> Table:
    """What was sent and what arrived."""
    table = Table("messages", "sent/s", "sent", "received", "lost", "median", "p99 [ms]")
    table.caption = (
        "median and p99: of the time from publication to callback. Best effort may lose messages, and so may the "
        "viewer, whose subscription keeps the newest: its depth is 1."
    )
    for outcome in outcomes:
        sent, got = outcome.publisher, outcome.subscriber
        counts = (f"{number:,}" for number in (sent["sent"], got["received"], outcome.lost))
        table.add_row(outcome.kind, f"{sent['rate']:.1f}", *counts, f"{got['median']:.2f}", f"{got['p99']:.2f}")
    return table


def table_of_memory(outcomes: list[Outcome]) -> Table:
    """How the memory of each process went."""
    table = Table("memory [MB]", "process", "start", "1st third", "2nd third", "3rd third", "end", "growth")
    table.caption = f"resident memory, after a warm-up of {WARM_UP:.0%} of the run."
    for outcome in outcomes:
        for process, memory in outcome.memories.items():
            values = (f"{value:.1f}" for value in (memory.start, *memory.thirds, memory.end))
            table.add_row(outcome.kind, process, *values, f"{memory.growth:+.1f}")
    return table


def show(outcomes: list[Outcome], console: Console) -> None:
    """Print the tables."""
    for table in (table_of_messages(outcomes), table_of_memory(outcomes)):
        for column in table.columns[1:]:
            column.justify = "right"
        table.caption_justify = "left"
        console.print(table)
    for waiting in (outcome.subscriber["waiting"] for outcome in outcomes if "waiting" in outcome.subscriber):
        thirds = ", ".join(f"{third:.0f}" for third in waiting["thirds"])
        console.print(f"calls that waited for the viewer's main thread: {thirds} by thirds, {waiting['most']} at most")


def soak(duration: int, kinds: Sequence[str], console: Console) -> int:
    """Run each kind of traffic in turn; return the exit status."""
    outcomes = []
    with reserved_domain() as domain:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        for kind in [kind for kind in kinds if kind in KINDS]:
            console.print(f"{kind}, {duration} s:")
            with progress_bar(duration, shown=True) as progress:
                outcomes.append(run(kind, KINDS[kind], duration, progress))
        if outcomes:
            show(outcomes, console)
        complaints = [f"{outcome.kind}: {complaint}" for outcome in outcomes for complaint in outcome.complaints()]
        if HOSTILE in kinds:
            complaints += hostile(duration, console)
    return judge(complaints, console)


@click.command(help=__doc__)
@click.argument("duration", metavar="[SECONDS]", type=click.IntRange(1, 86_400), default=60)
@click.argument("kinds", metavar="[KIND]...", nargs=-1, type=click.Choice([*KINDS, HOSTILE]))
def main(duration: int, kinds: tuple[str, ...]) -> None:
    """Do what the command line asks for, and exit with its status."""
    console = Console(width=None if sys.stdout.isatty() else 120)
    try:
        sys.exit(soak(duration, kinds or (*KINDS, HOSTILE), console))
    except KeyboardInterrupt:
        console.print("stopped")
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
