"""The process that reads a notebook, or judges one of its answers: ``python -m tutorial.commands.checking._child``.

Its arguments are the notebook's file descriptor, the CPU time limit per process [s], whether this process is in a
sandbox, and optionally the name of an exercise. With a name, it judges the answer to that exercise; without a name, it
lists the exercises. It writes one message to stdout and exits when its parent exits.
"""

import asyncio
import os
import signal
import sys
import threading
from collections.abc import Mapping
from typing import NoReturn

import msgspec

from tutorial.checks.catalogue import exercises
from tutorial.checks.engine.verdict import Verdict
from tutorial.checks.exercise import NOT_YET, Exercise
from tutorial.commands.checking.answers import Answer, cells_of, find_answers, find_driver
from tutorial.commands.checking.messages import Judged, Opened, Outcome
from tutorial.commands.checking.sandbox import limit
from tutorial.errors import TutorialError

UNDEFINED = "The answer probably depends on a cell that only works in a running notebook."


def main() -> NoReturn:
    """Read a notebook or judge an answer, write the message, and exit before any more of the answer's code can run."""
    notebook, seconds, is_sandboxed, *exercise = sys.argv[1:]
    os.set_inheritable(int(notebook), False)
    report = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # discards the answers' output
    limit(int(seconds), is_sandboxed == "True")
    threading.Thread(target=_end_with_the_teacher, name="parent watch", daemon=True).start()
    known = {each.name: each for those in exercises().values() for each in those}
    answers, driver, problem = _open(int(notebook), known)
    message = _judge(known[exercise[0]], answers[exercise[0]]) if exercise else Opened(list(answers), problem, driver)
    with os.fdopen(report, "wb") as file:
        file.write(msgspec.json.encode(message) + b"\n")
    os._exit(0)


def _end_with_the_teacher() -> None:
    """Wait until the teacher's process closes stdin or exits, then kill this process and its children."""
    os.read(0, 1)
    os.killpg(0, signal.SIGKILL)
    os._exit(1)  # a sandbox's first process survives its own SIGKILL, but its exit ends all other processes


def _open(notebook: int, known: Mapping[str, Exercise]) -> tuple[dict[str, Answer], str, str]:
    """Return a notebook's answers by exercise, its driver, and the problem with the file, if any."""
    try:
        with open(notebook, encoding="utf-8") as file:
            cells = cells_of(file.read())
        answers = find_answers(cells, {name: each.right_answer.__name__ for name, each in known.items()})
    except Exception as error:  # noqa: BLE001 - the file can be anything
        return {}, "", f"not a notebook: {type(error).__name__}: {error}"
    return {answer.exercise: answer for answer in answers}, find_driver(cells), ""


def _judge(exercise: Exercise, answer: Answer) -> Judged:
    if answer.given is None:
        outcome = Outcome.WRONG if answer.unreadable else Outcome.NOT_TRIED
        return Judged(outcome, answer.unreadable, answer.unreadable)
    try:
        given = answer.define()
    except BaseException as error:  # noqa: BLE001 - a learner's code can even call sys.exit
        text = f"The answer's definition failed: {type(error).__name__}: {error}".removesuffix(": ")
        return Judged(Outcome.WRONG, UNDEFINED, f"{text}\n  {UNDEFINED}")
    try:
        seen = asyncio.run(exercise.examine(given))
    except TutorialError as error:  # no ROS domain is free
        return Judged(Outcome.NOT_JUDGED, str(error), str(error))
    if isinstance(seen, Verdict):
        return Judged(Outcome.RIGHT if seen.right else Outcome.WRONG, " ".join(seen.causes[:1]), str(seen))
    if str(seen).startswith(NOT_YET):
        return Judged(Outcome.NOT_TRIED, "", str(seen))
    return Judged(Outcome.WRONG, str(seen), str(seen))


if __name__ == "__main__":
    main()
