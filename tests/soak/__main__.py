"""A thousand messages a second for a while, between two processes: what is lost, how late it is, and whether memory
stays flat; then the same into the viewer of step 3, whose queue must not grow; then into a bag.

``make soak`` runs it. Its exit status is 1 if something does not hold; below the table it says what.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import click

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
from domains import reserved_domain
from tables import console, show
from traffic import PATIENCE, RATE, WARM_UP

from tutorial.commands.terminal import progress_bar

TRAFFIC = Path(__file__).with_name("traffic.py")
OTHER_ENDS = {"reliable": "subscribe", "hand-off": "show", "bag": "record"}
"""Each kind of traffic, and what receives it: a role of traffic.py."""
BACKLOG = 100  # calls that may wait for the viewer's main thread, in the median of a third: a tenth of a second's
RATE_BOUND = 0.99 * RATE
GRACE = 10.0  # [s] from asking a process to stop to killing it
GROWTH = 4.0
"""How much memory may grow after the warm-up [MB]. In a run of 60 s, 45,000 messages are sent in that time, so 100
bytes that stay behind of each are found: a copy of a message of 40 joints is 1,700. What is no leak is below it: the
backlog of a second in which a busy machine did something else, of which malloc keeps the pages, and an arena that the
interpreter adds."""

Result = dict[str, Any]


@contextmanager
def end(*arguments: object) -> Iterator[subprocess.Popen[str]]:
    """Run traffic.py in a group of its own, which spares it the terminal's Ctrl-C.

    The end of its input asks it to stop; what still runs after a time of grace is killed.
    """
    command, pipe = [sys.executable, TRAFFIC, *arguments], subprocess.PIPE
    with subprocess.Popen([*map(str, command)], stdin=pipe, stdout=pipe, text=True, process_group=0) as process:
        try:
            yield process
        finally:
            process.stdin.close()
            with suppress(subprocess.TimeoutExpired):
                process.wait(GRACE)
            process.kill()


def run(kind: str, seconds: float) -> tuple[str, Result, Result]:
    """Run a publisher and another end for a while; return the kind, and what both have said.

    Raises:
        SystemExit: one of them has failed, or does not end.
    """
    console.print(f"{kind}, {seconds} s:")
    with progress_bar(seconds) as progress, ExitStack() as stack:
        ends = [stack.enter_context(end(role, kind, seconds)) for role in ("publish", OTHER_ENDS[kind])]
        stack.callback(lambda: [end.stdin.close() for end in ends])  # both are asked before either is waited for
        began = time.monotonic()
        while any(end.poll() is None for end in ends):
            progress(time.monotonic() - began)
            if any(end.poll() for end in ends) or time.monotonic() - began > 3 * seconds + 2 * PATIENCE:
                raise SystemExit(f"{kind}: a process has failed, or should have ended long ago; see above")
            time.sleep(0.05)
        sent, got = (json.loads(end.stdout.read().splitlines()[-1]) for end in ends)
    return kind, sent, got


def complaints(kind: str, sent: Result, got: Result) -> Iterator[str]:
    """What does not hold of what should."""
    if sent["rate"] < RATE_BOUND:
        yield f"{sent['rate']:.0f} messages a second were sent, at least {RATE_BOUND:.0f} are asked for"
    if kind != "hand-off" and sent["sent"] > got["received"]:
        yield f"{sent['sent'] - got['received']} messages were lost"
    if got["disordered"]:
        yield f"{got['disordered']} messages came out of order"
    for (start, last), whose in ((sent["memory"], "publisher"), (got["memory"], "other end")):
        if last - start > GROWTH:
            yield f"the {whose}'s memory has grown by {last - start:.1f} MB, at most {GROWTH:g} are allowed"
    if got["received"] != got.get("applied", got["received"]):
        yield f"{got['received']} messages were received, but {got['applied']} shown"
    if got.get("waiting", 0) > BACKLOG:
        yield f"the viewer's queue has grown: in the last third {got['waiting']:.0f} waited, at most {BACKLOG} may"


def row(kind: str, sent: Result, got: Result) -> tuple[str, ...]:
    """Say what was sent and what arrived, and how the memory went."""
    counts = (f"{number:,}" for number in (sent["sent"], got["received"], sent["sent"] - got["received"]))
    growths = (f"{last - start:+.1f} to {last:.0f}" for start, last in (sent["memory"], got["memory"]))
    return kind, f"{sent['rate']:.1f}", *counts, f"{got['median']:.2f}", f"{got['p99']:.2f}", *growths


@click.command(help=__doc__)
@click.argument("duration", metavar="[SECONDS]", type=click.IntRange(1, 86_400), default=60)
def main(duration: int) -> None:
    with reserved_domain() as domain:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        outcomes = [run(kind, duration) for kind in OTHER_ENDS]
    show(
        ("messages", "sent/s", "sent", "received", "lost", "median", "p99 [ms]", "memory [MB]", "of the other end"),
        (row(*outcome) for outcome in outcomes),
        "median and p99: of the time from publication to callback. The viewer may lose messages: its subscription "
        "keeps the newest, for its depth is 1. memory: how much the publisher's, and the other end's, has grown after "
        f"a warm-up of {WARM_UP:.0%} of the run.",
    )
    broken = [f"{outcome[0]}: {complaint}" for outcome in outcomes for complaint in complaints(*outcome)]
    for complaint in broken:
        console.print(f"does not hold: {complaint}", style="red", highlight=False)
    console.print("" if broken else "all holds", end="" if broken else "\n")
    sys.exit(bool(broken))


if __name__ == "__main__":
    main()
