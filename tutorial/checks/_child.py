"""The process that an answer is judged in: ``python -m tutorial.checks._child``.

The job comes by stdin, as one line, and stdin stays open as long as whoever has asked lives. What is found goes to
stdout as lines of JSON, and ``done`` is the last of them; what Python itself has to say when it dies is written there,
too, past every lock. What the learner's code prints goes to stderr. A watchdog looks ten times a second whether one of
the learner's methods does not return; it counts its own looks, not seconds, so that a machine with much else to do is
not held against the learner.
"""

import faulthandler
import importlib
import os
import pickle
import select
import signal
import sys
import threading
from collections import Counter
from io import BufferedReader, FileIO
from traceback import walk_stack
from typing import NoReturn

import msgspec

from tutorial.checks._contain import CLINGS, DONE
from tutorial.checks._diagnose import endless
from tutorial.checks._verdict import Finding, wrong
from tutorial.checks._watch import instrumented, watch

LOOK = 0.1  # [s] between two looks of the watchdog
PATIENCE = 15  # looks that a single call may take; it should take none
BUDGET = 25  # looks that all calls of one method may take together
HALT = 5.0  # [s] without a look, after which the watchdog itself is held up


def main() -> NoReturn:
    """Judge the answer, and end the process."""
    report = os.fdopen(os.dup(1), "wb", 0)  # two threads write: each line at once, so none splits another's
    os.dup2(2, 1)
    parent = open(os.dup(0), "rb")  # noqa: SIM115, PTH123 - it stays open to the end
    module, name, sys.path[:], answer = pickle.load(parent)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    faulthandler.enable(report)
    threading.Thread(target=_watchdog, args=(report, parent), name="watchdog", daemon=True).start()
    with instrumented():  # before the answer is there, for it may have its own name for time.sleep
        exercise = getattr(importlib.import_module(module), name)
        try:
            findings = exercise.findings(pickle.loads(answer))
        except Exception as error:  # noqa: BLE001 - unpickling runs the learner's code
            text = f"the answer cannot be run in a process of its own: {type(error).__name__}: {error}"
            findings = [wrong(text, CLINGS)]
        for finding in findings:
            _tell(report, finding)
    _end(report)


def _watchdog(report: FileIO, parent: BufferedReader) -> None:
    """Look whether who has asked still lives, and whether a method of the learner's does not return."""
    looks: Counter[tuple[str, int]] = Counter()
    sums: Counter[str] = Counter()
    while not select.select([parent], [], [], LOOK)[0]:
        faulthandler.dump_traceback_later(HALT, exit=True, file=report)
        running = {ident: call for ident, calls in [*watch.running.items()] for call in calls[-1:]}
        looks = Counter({call: looks[call] + 1 for call in running.values()})
        if not (watch.interleaved or watch.explaining):
            sums.update({method for method, _ in running.values()})
        for ident, (method, number) in running.items():
            if looks[method, number] > PATIENCE or sums[method] > BUDGET:
                _give_up(report, ident, method, looks[method, number] > PATIENCE)
    os.killpg(0, signal.SIGKILL)


def _give_up(report: FileIO, ident: int, method: str, stuck: bool) -> NoReturn:
    """Say which method does not return, and where it is; then end the process."""
    text = f"{method} does not return" if stuck else f"{method} takes too long, at every call"
    _tell(report, wrong(text, endless(method), watch.place(walk_stack(sys._current_frames().get(ident)))))
    _end(report)


def _tell(report: FileIO, finding: Finding) -> None:
    report.write(msgspec.json.encode(finding) + b"\n")


def _end(report: FileIO) -> NoReturn:
    report.write(DONE)
    os._exit(0)


if __name__ == "__main__":
    main()
