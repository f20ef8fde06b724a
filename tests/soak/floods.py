"""What a viewer bears: somebody means harm, and sends announcements, names, messages, requests or packets without end
to the viewer of step 3. Its main loop is not to be held, its memory is not to grow, the terminal is not to be filled,
and when it is told to end, it ends.

``make soak`` runs it, too. Its exit status is 1 if something does not hold; below the table it says what.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

import click
import psutil
from domains import reserved_domain
from rich.console import Console
from rich.table import Table
from verdict import judge

from tutorial.commands.terminal import INTERRUPTED, progress_bar

HERE = Path(__file__).parent
KINDS = ("nothing", "announcements", "names", "messages", "requests", "encapsulations")
SETTLED = 2.0  # [s] that the viewer runs before it is attacked
PATIENCE = 60.0  # [s]
MB = 1e6

HOLD_BOUND = 100.0  # [ms]
GROWTH_BOUND = 50.0  # [MB]
LINES_BOUND = 1.0  # [Hz]
END_BOUND = 2.0  # [s] from SIGTERM to the end


@dataclass
class Outcome:
    """How the viewer bore one kind of flood."""

    kind: str
    sent: int
    hold: float  # [ms]
    growth: float  # [MB]
    lines: float  # [Hz]
    end: float  # [s]

    def complaints(self) -> Iterator[str]:
        """What does not hold of what should."""
        if self.hold > HOLD_BOUND:
            yield f"the main loop was held for {self.hold:.0f} ms, at most {HOLD_BOUND:g} are allowed"
        if self.growth > GROWTH_BOUND:
            yield f"the memory has grown by {self.growth:.0f} MB, at most {GROWTH_BOUND:g} are allowed"
        if self.lines > LINES_BOUND:
            yield f"{self.lines:.1f} lines a second were printed, at most {LINES_BOUND:g} are allowed"
        if self.end > END_BOUND:
            yield f"it took {self.end:.1f} s to end, at most {END_BOUND:g} are allowed"


@dataclass
class Victim:
    """The viewer, and what is to be seen of it from outside."""

    process: subprocess.Popen[str]
    port: int
    holds: list[float] = field(default_factory=list)  # [s], the longest of each tenth of a second
    lines: list[str] = field(default_factory=list)

    def memory(self) -> float:
        """Its resident memory [MB]."""
        return psutil.Process(self.process.pid).memory_info().rss / MB

    def wait(self, condition: Callable[[], object]) -> None:
        """Wait until something is so; raises SystemExit if it never is."""
        deadline = time.monotonic() + PATIENCE
        while not condition():
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise SystemExit("the viewer does not run:\n" + "".join(self.lines))
            time.sleep(0.02)


def keep(file: IO[str], into: Callable[[str], object]) -> None:
    """Hand all lines of a file on, on a thread."""
    threading.Thread(target=lambda: [into(line) for line in file], daemon=True).start()


@contextmanager
def process(*command: object, **options: object) -> Iterator[subprocess.Popen[str]]:
    """Run a Python program in a group of its own, which spares it the terminal's Ctrl-C; kill what is left of it."""
    arguments = [sys.executable, *map(str, command)]
    options = {"stdout": subprocess.PIPE, "text": True, "process_group": 0, **options}
    with subprocess.Popen(arguments, stdin=subprocess.DEVNULL, **options) as started:  # type: ignore[call-overload]
        try:
            yield started
        finally:
            started.kill()


@contextmanager
def viewer() -> Iterator[Victim]:
    """Start the viewer of step 3 with its page, and wait until it runs."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    reading, writing = os.pipe()
    options = {"pass_fds": [writing], "stderr": subprocess.STDOUT, "env": {**os.environ, "HOLDS_FD": str(writing)}}
    with process(HERE / "victim.py", "run", "step3", "--port", port, **options) as started:
        os.close(writing)
        victim = Victim(started, port)
        keep(started.stdout, victim.lines.append)
        keep(os.fdopen(reading), lambda line: victim.holds.append(float(line)))
        victim.wait(lambda: len(victim.holds) > SETTLED / 0.1)
        yield victim


def flood(kind: str, seconds: float, progress: Callable[[float], object]) -> Outcome:
    """Attack a viewer for a while, then tell it to end while the attack goes on.

    Args:
        kind: of the attack.
        seconds: how long [s].
        progress: called with the seconds that have passed.
    """
    with viewer() as victim, process(HERE / "attack.py", kind, seconds + PATIENCE, victim.port) as attacker:
        attacker.stdout.readline()
        start, lines, holds = victim.memory(), len(victim.lines), len(victim.holds)
        growth, began = 0.0, time.monotonic()
        while (elapsed := time.monotonic() - began) < seconds:
            progress(elapsed)
            victim.wait(lambda: True)
            growth = max(growth, victim.memory() - start)
            time.sleep(0.1)
        printed = len(victim.lines) - lines
        asked = time.monotonic()
        victim.process.send_signal(signal.SIGTERM)
        with suppress(subprocess.TimeoutExpired):
            victim.process.wait(PATIENCE)
        end = time.monotonic() - asked
        attacker.send_signal(signal.SIGINT)
        sent = attacker.stdout.readline()
    if not sent:
        raise SystemExit(f"{kind}: the attack has failed; see above")
    return Outcome(kind, int(sent), 1e3 * max(victim.holds[holds:]), growth, printed / seconds, end)


def show(outcomes: list[Outcome], console: Console) -> int:
    """Print the table and what does not hold; return the exit status."""
    table = Table("flood", "sent", "longest hold [ms]", "growth [MB]", "lines/s", "end [s]")
    for column in table.columns[1:]:
        column.justify = "right"
    for outcome in outcomes:
        numbers = f"{outcome.hold:.0f}", f"{outcome.growth:+.1f}", f"{outcome.lines:.1f}", f"{outcome.end:.1f}"
        table.add_row(outcome.kind, f"{outcome.sent:,}", *numbers)
    table.caption = (
        "hold: how long the viewer's main loop did nothing else. end: from SIGTERM, with the flood going on."
    )
    table.caption_justify = "left"
    console.print(table)
    return judge(
        [f"{outcome.kind}: {complaint}" for outcome in outcomes for complaint in outcome.complaints()], console
    )


def floods(duration: int, kinds: Iterable[str], console: Console) -> int:
    """Run each kind of flood in turn; return the exit status."""
    outcomes = []
    with reserved_domain() as domain:
        os.environ["ROS_DOMAIN_ID"] = str(domain)
        for kind in kinds:
            console.print(f"{kind}, {duration} s:")
            with progress_bar(duration, shown=True) as progress:
                outcomes.append(flood(kind, duration, progress))
    return show(outcomes, console)


@click.command(help=__doc__)
@click.argument("duration", metavar="[SECONDS]", type=click.IntRange(1, 86_400), default=30)
@click.argument("kinds", metavar="[KIND]...", nargs=-1, type=click.Choice(KINDS))
def main(duration: int, kinds: tuple[str, ...]) -> None:
    """Do what the command line asks for, and exit with its status."""
    console = Console(width=None if sys.stdout.isatty() else 120)
    try:
        sys.exit(floods(duration, kinds or KINDS, console))
    except KeyboardInterrupt:
        console.print("stopped")
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
