"""Running both ends of the traffic, and judging what they say."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from memory import BOUND, Trend
from traffic import PATIENCE, RATE

TRAFFIC = Path(__file__).with_name("traffic.py")
GRACE = 10.0  # [s] from asking a process to stop to killing it
BACKLOG = 100  # calls that may wait for the viewer's main thread, in the median of a third: a tenth of a second's
RATE_BOUND = 0.99 * RATE


@dataclass
class Outcome:
    """What both ends said about one kind of traffic."""

    kind: str
    publisher: dict[str, Any]
    subscriber: dict[str, Any]

    @property
    def lost(self) -> int:
        return self.publisher["sent"] - self.subscriber["received"]

    @property
    def memories(self) -> dict[str, Trend]:
        """How the memory of each process went."""
        ends = (("publisher", self.publisher), (self._other, self.subscriber))
        return {name: Trend(*end["memory"]) for name, end in ends}

    @property
    def _other(self) -> str:
        return "viewer" if "waiting" in self.subscriber else "subscriber"

    def complaints(self) -> Iterator[str]:
        """What does not hold of what should."""
        if self.publisher["rate"] < RATE_BOUND:
            yield f"{self.publisher['rate']:.0f} messages a second were sent, at least {RATE_BOUND:.0f} are asked for"
        if self.kind == "reliable" and self.lost:
            yield f"{self.lost} messages were lost"
        if self.subscriber["disordered"]:
            yield f"{self.subscriber['disordered']} messages came out of order"
        for process, memory in self.memories.items():
            if not memory.flat:
                yield f"the {process}'s memory has grown by {memory.growth:.1f} MB, at most {BOUND:g} are allowed"
        if "waiting" in self.subscriber:
            yield from self._complaints_of_the_viewer()

    def _complaints_of_the_viewer(self) -> Iterator[str]:
        received, applied = self.subscriber["received"], self.subscriber["applied"]
        if received != applied:
            yield f"{received} messages were received, but {applied} shown"
        if self.subscriber["waiting"]["thirds"][-1] > BACKLOG:
            thirds = ", ".join(f"{third:.0f}" for third in self.subscriber["waiting"]["thirds"])
            yield f"the viewer's queue has grown: {thirds} calls waited, at most {BACKLOG} may"


def run(kind: str, other: str, seconds: float, progress: Callable[[float], object]) -> Outcome:
    """Run a publisher and another end for a while.

    Args:
        kind: of the traffic.
        other: the role of the other end.
        seconds: how long to publish [s].
        progress: called with the seconds that have passed.

    Raises:
        SystemExit: one of them has failed, or does not end.
    """
    with ExitStack() as stack:
        roles = (other, "publish")
        ends = [stack.enter_context(one_end(role, kind, seconds)) for role in roles]
        stack.callback(lambda: [end.stdin.close() for end in ends])  # both are asked before either is waited for
        began = time.monotonic()
        while any(end.poll() is None for end in ends):
            progress(time.monotonic() - began)
            if any(end.poll() for end in ends):
                raise SystemExit(f"{kind}: a process has failed; see above")
            if time.monotonic() - began > 3 * seconds + 2 * PATIENCE:
                raise SystemExit(f"{kind}: it should have ended long ago")
            time.sleep(0.05)
        said, published = (json.loads(end.stdout.read().splitlines()[-1]) for end in ends)
    return Outcome(kind, published, said)


@contextmanager
def one_end(role: str, kind: str, seconds: float) -> Iterator[subprocess.Popen[str]]:
    """Start one end. A group of its own spares it the terminal's Ctrl-C: the end of its input asks it to stop."""
    command = [sys.executable, str(TRAFFIC), role, kind, str(seconds)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, process_group=0
    ) as process:
        try:
            yield process
        finally:
            process.stdin.close()
            try:
                process.wait(GRACE)
            except subprocess.TimeoutExpired:
                pass
            finally:
                process.kill()
