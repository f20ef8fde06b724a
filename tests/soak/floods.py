"""Flood step 3's viewer with names, messages or packets, as an attacker would. The viewer's main loop must
not hang, its memory must not grow, and it must neither fill the terminal nor ignore a request to stop.

``make soak`` runs it, too. If a requirement is not met, the program prints it at the end, and the exit status is 1.
"""

import signal
import subprocess
import threading
import time
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil
from harness import MEMORY, above, python, soak
from tables import console

from tutorial.system.parent_watch import signal_group

HERE = Path(__file__).parent
KINDS = ("names", "messages", "encapsulations")
SETTLED = 20  # how many tenths of a second the viewer runs before the attack
TIMEOUT = 60.0  # [s]
BOUNDS = {
    "the main loop was blocked for {:.0f} ms, at most {:g} are allowed": 100.0,
    f"the {MEMORY}": 50.0,
    "{:.1f} lines a second were printed, at most {:g} are allowed": 1.0,
    "it took {:.1f} s to end after SIGTERM, at most {:g} are allowed": 2.0,
}


def flood(kind: str, seconds: float) -> list[float]:
    """Attack a viewer for a while, then ask it to stop while the attack goes on.

    Returns:
        The values that `BOUNDS` limits.
    """
    console.print(f"{kind}, {seconds} s:")
    lines: list[str] = []
    with TemporaryDirectory() as folder:
        written = Path(folder) / "holds"
        written.touch()

        def holds() -> list[float]:
            """Return the longest hold of the main loop in each tenth of a second [s]."""
            return [float(hold) for hold in written.read_text().split("\n")[:-1]]

        with python(HERE / "victim.py", "run", "step3", HOLDS=str(written)) as victim:
            threading.Thread(target=lambda: lines.extend(victim.stdout), daemon=True).start()
            deadline = time.monotonic() + TIMEOUT
            while len(holds()) < SETTLED:
                if victim.poll() is not None or time.monotonic() > deadline:
                    raise SystemExit("the viewer does not run:\n" + "".join(lines))
                time.sleep(0.02)
            with python(HERE / "attack.py", kind, seconds + TIMEOUT) as attacker:
                attacker.stdout.readline()
                (viewer,) = psutil.Process(victim.pid).children()
                start, printed, quiet = viewer.memory_info().rss, len(lines), len(holds())
                most, began = start, time.monotonic()
                while (elapsed := time.monotonic() - began) < seconds and victim.poll() is None:
                    most = max(most, viewer.memory_info().rss)
                    time.sleep(0.1)
                printed = len(lines) - printed
                asked = time.monotonic()
                viewer.send_signal(signal.SIGTERM)
                with suppress(subprocess.TimeoutExpired):
                    victim.wait(TIMEOUT)
                end = time.monotonic() - asked
                signal_group(attacker.pid, signal.SIGINT)
                sent = attacker.stdout.readline()
        longest = max(holds()[quiet:])
    if not sent or elapsed < seconds:
        raise SystemExit(f"{kind}: the attack or the viewer has failed; see above\n{''.join(lines)}")
    console.print(f"  {int(sent):,} sent")
    return [1e3 * longest, (most - start) / 1e6, printed / seconds, end]


def floods(duration: int) -> list[str]:
    """Run each kind of flood in turn, print the values with their bounds, and return the unmet requirements."""
    complaints = []
    for kind in KINDS:
        limits = tuple(zip(flood(kind, duration), BOUNDS.values(), BOUNDS))
        for value, bound, text in limits:
            console.print(f"  {text.format(value, bound)}")
        complaints += [f"{kind}: {complaint}" for complaint in above(*limits)]
    return complaints


if __name__ == "__main__":
    soak(30, floods)
