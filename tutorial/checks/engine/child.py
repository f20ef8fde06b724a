"""The process that judges an answer: ``python -m tutorial.checks.engine.child``.

It reads the job from stdin, which stays open while the parent process is running. It writes the findings to stdout as
lines of JSON, with ``done`` as the last line. If Python crashes, it also writes a traceback to stdout, without waiting
for any lock. The output of the learner's code goes to stderr. A watchdog checks ten times a second whether one of the
learner's methods is stuck. The watchdog counts checks, not seconds, so a busy machine does not cause wrong verdicts.
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
from collections.abc import Iterable
from io import BufferedReader, FileIO
from traceback import walk_stack
from typing import NoReturn

import msgspec

from tutorial.checks.engine.contain import CLINGS, DONE
from tutorial.checks.engine.exceptions import endless
from tutorial.checks.engine.instruments import Instruments
from tutorial.checks.engine.trial import Call, Trial
from tutorial.checks.engine.verdict import Finding, wrong

LOOK = 0.1  # [s] between the watchdog's checks
TIMEOUT = 15  # a call that is still running after this many checks counts as stuck
BUDGET = 25  # the maximum total number of checks over all calls to one method
HALT = 5.0  # [s] how long the watchdog can go without a check before it counts as blocked itself


def main() -> NoReturn:
    """Judge the answer, and exit."""
    report = os.fdopen(os.dup(1), "wb", 0)  # unbuffered: each line is one write, so lines from two threads don't mix
    os.dup2(2, 1)
    parent = open(os.dup(0), "rb")  # noqa: SIM115, PTH123 - stays open to the end
    module, name, sys.path[:], answer = pickle.load(parent)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    faulthandler.enable(report)
    with Instruments() as instruments:  # before loading the answer, which may import sleep from time
        threading.Thread(target=_watchdog, args=(instruments, report, parent), name="watchdog", daemon=True).start()
        for finding in _findings(module, name, answer, instruments):
            _tell(report, finding)
    _end(report)


def _findings(module: str, name: str, answer: bytes, instruments: Instruments) -> Iterable[Finding]:
    exercise = getattr(importlib.import_module(module), name)
    try:
        findings: Iterable[Finding] = exercise.findings(pickle.loads(answer), instruments)
    except Exception as error:  # noqa: BLE001 - unpickling runs the learner's code
        text = f"the answer cannot run in a separate process: {type(error).__name__}: {error}"
        return [wrong(text, CLINGS)]
    return findings


def _watchdog(instruments: Instruments, report: FileIO, parent: BufferedReader) -> None:
    """Stop the process if its parent has died, or if one of the learner's methods does not return."""
    looks: Counter[Call] = Counter()
    sums: Counter[str] = Counter()
    while not select.select([parent], [], [], LOOK)[0]:
        faulthandler.dump_traceback_later(HALT, exit=True, file=report)
        trial = instruments.trial
        if trial is None:
            continue
        running = trial.innermost()
        looks = Counter({call: looks[call] + 1 for call in running.values()})
        if trial.is_timed and not trial.is_interleaved:
            sums.update({call.method for call in running.values()})
        for ident, call in running.items():
            if looks[call] > TIMEOUT or sums[call.method] > BUDGET:
                _give_up(report, trial, ident, call.method, looks[call] > TIMEOUT)
    os.killpg(0, signal.SIGKILL)


def _give_up(report: FileIO, trial: Trial, ident: int, method: str, stuck: bool) -> NoReturn:
    """Report the method that does not return, with its current line, and exit."""
    text = f"{method} does not return" if stuck else f"the calls to {method} take too long"
    _tell(report, wrong(text, endless(method), trial.place(walk_stack(sys._current_frames().get(ident)))))
    _end(report)


def _tell(report: FileIO, finding: Finding) -> None:
    report.write(msgspec.json.encode(finding) + b"\n")


def _end(report: FileIO) -> NoReturn:
    report.write(DONE)
    os._exit(0)


if __name__ == "__main__":
    main()
