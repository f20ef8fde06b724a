"""Send a thousand messages a second between two processes: check losses, latencies, and that memory stays
flat. Then send them to step 3's viewer, whose queue must not grow, and record them in a bag.

``make soak`` runs it, and prints the measurements of both ends: the rate [1/s], the latency from publication to
callback, as median and worst hundredth [ms], and the growth of memory after a warm-up [MB]. Best effort may lose
messages, and so may the viewer: its subscription keeps only the newest one. If a requirement is not met, the program
prints it at the end, and the exit status is 1.
"""

import json
import time
from collections.abc import Iterator
from pathlib import Path

import tutorial  # noqa: F401 - makes rclpy importable

# isort: split
from harness import GROWTH, MEMORY, above, python, soak
from tables import console
from traffic import RATE, TIMEOUT

TRAFFIC = Path(__file__).with_name("traffic.py")
OTHER_ENDS = {"reliable": "subscribe", "best effort": "subscribe", "hand-off": "show", "bag": "record"}
"""The kinds of traffic, and the role of traffic.py that receives each."""
BACKLOG = 100  # maximum median of the calls waiting for the viewer's main thread: a tenth of a second's
RATE_BOUND = 0.99 * RATE

Result = dict[str, float]


def run(kind: str, seconds: float) -> tuple[Result, Result]:
    """Run a publisher and a receiver for a while; print and return the results of both.

    Raises:
        SystemExit: one of them has failed, or does not exit.
    """
    console.print(f"{kind}, {seconds} s:")
    with python(TRAFFIC, "publish", kind, seconds) as one, python(TRAFFIC, OTHER_ENDS[kind], kind, seconds) as other:
        deadline = time.monotonic() + 3 * seconds + 2 * TIMEOUT
        while None in (statuses := [end.poll() for end in (one, other)]) and not any(statuses):
            if time.monotonic() > deadline:
                raise SystemExit(f"{kind}: a process should have ended long ago")
            time.sleep(0.05)
        if any(statuses):
            raise SystemExit(f"{kind}: a process has failed\n{(one if statuses[0] else other).stdout.read()}")
        sent, got = (json.loads(end.stdout.read().splitlines()[-1]) for end in (one, other))
    for end, said in ((" publisher", sent), (" other end", got)):
        console.print(end, *(f"{name} {value:,.2f}" for name, value in said.items()), sep=", ")
    return sent, got


def complaints(kind: str, sent: Result, got: Result) -> Iterator[str]:
    """Yield the requirements that the results do not meet."""
    if sent["rate"] < RATE_BOUND:
        yield f"{sent['rate']:.0f} messages a second were sent, at least {RATE_BOUND:.0f} are required"
    if kind in ("reliable", "bag") and sent["sent"] > got["received"]:
        yield f"{sent['sent'] - got['received']} messages were lost"
    if got["disordered"]:
        yield f"{got['disordered']} messages arrived out of order"
    for grown, whose in ((sent["grown"], "publisher"), (got["grown"], "other end")):
        yield from above((grown, GROWTH, f"the {whose}'s {MEMORY}"))
    if got["received"] != got.get("applied", got["received"]):
        yield f"{got['received']} messages were received, but {got['applied']} shown"
    queue = "the viewer's queue has grown: in the last third {:.0f} calls waited, at most {} may wait"
    yield from above((got.get("waiting", 0), BACKLOG, queue))


def messages_and_memory(duration: int) -> list[str]:
    """Run each kind of traffic in turn; return the requirements that are not met."""
    return [f"{kind}: {complaint}" for kind in OTHER_ENDS for complaint in complaints(kind, *run(kind, duration))]


if __name__ == "__main__":
    soak(60, messages_and_memory)
