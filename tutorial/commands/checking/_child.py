"""The process in which a notebook is read and its answers are judged: ``python -m tutorial.commands.checking._child``.

It is given the descriptor of the notebook, the processor time [s] that a process may take, whether it is in a sandbox,
and the names of exercises that are done already. Its messages go to stdout. It does not end by itself, but is killed by
whoever has started it, or when that is gone.
"""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import threading
from collections.abc import Callable, Collection
from typing import NoReturn

import msgspec

from tutorial.checks._verdict import Verdict
from tutorial.checks.catalogue import exercises
from tutorial.checks.exercise import NOT_YET, Exercise
from tutorial.commands.checking.answers import Answer, cells_of, find_answers
from tutorial.commands.checking.messages import Done, Judged, Message, Opened, Outcome, Trying, Unreadable
from tutorial.commands.checking.sandbox import limit

UNDEFINED = "Most likely the answer needs something of a cell that only works in a running notebook."


def main() -> NoReturn:
    """Judge a notebook, and wait to be killed."""
    notebook, seconds, is_sandboxed, *done = sys.argv[1:]
    os.set_inheritable(int(notebook), False)
    report = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # where what an answer prints goes
    limit(int(seconds), is_sandboxed == "True")
    threading.Thread(target=_end_with_the_teacher, name="parent watch", daemon=True).start()

    def tell(message: Message) -> None:
        line = msgspec.json.encode(message) + b"\n"
        while line:
            line = line[os.write(report, line) :]

    _judge_all(int(notebook), done, tell)
    tell(Done())
    while True:
        signal.pause()


def _end_with_the_teacher() -> None:
    """Wait until the other end of stdin is closed, by whoever holds it or by his death."""
    os.read(0, 1)
    os.killpg(0, signal.SIGKILL)


def _judge_all(notebook: int, done: Collection[str], tell: Callable[[Message], None]) -> None:
    known = {each.name: each for those in exercises().values() for each in those}
    try:
        with open(notebook, encoding="utf-8") as file:
            cells = cells_of(file.read())
        answers = find_answers(cells, {name: each.right_answer.__name__ for name, each in known.items()})
    except Exception as error:  # noqa: BLE001 - the file may be anything
        tell(Unreadable(f"it is no notebook: {type(error).__name__}: {error}"))
        return
    tell(Opened(tuple(answer.exercise for answer in answers)))
    for answer in answers:
        if answer.exercise not in done:
            tell(Trying(answer.exercise))
            tell(_judge(known[answer.exercise], answer))


def _judge(exercise: Exercise, answer: Answer) -> Judged:
    name = exercise.name
    if answer.given is None:
        outcome = Outcome.WRONG if answer.unreadable else Outcome.NOT_TRIED
        return Judged(name, outcome, answer.unreadable, answer.unreadable)
    try:
        given = answer.define()
    except BaseException as error:  # noqa: BLE001 - it is a learner's code, which may call sys.exit
        text = f"The answer cannot be defined: {type(error).__name__}: {error}".removesuffix(": ")
        return Judged(name, Outcome.WRONG, UNDEFINED, f"{text}\n  {UNDEFINED}")
    seen = asyncio.run(exercise.examine(given))
    if isinstance(seen, Verdict):
        return Judged(name, Outcome.RIGHT if seen.right else Outcome.WRONG, " ".join(seen.causes[:1]), str(seen))
    if str(seen).startswith(NOT_YET):
        return Judged(name, Outcome.NOT_TRIED, "", str(seen))
    return Judged(name, Outcome.WRONG, str(seen), str(seen))


if __name__ == "__main__":
    main()
