"""The process that reads a notebook, or judges one of its answers: ``python -m tutorial.commands.checking._child``.

It is given the descriptor of the notebook, the processor time [s] that a process may take, whether it is in a sandbox,
and the name of the exercise. Without a name it lists the exercises. It writes one message to stdout. It ends when the
process that started it is gone.
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
from tutorial.commands.checking.answers import Answer, cells_of, find_answers
from tutorial.commands.checking.messages import Judged, Opened, Outcome
from tutorial.commands.checking.sandbox import limit
from tutorial.errors import TutorialError

UNDEFINED = "The answer probably needs something of a cell that only works in a running notebook."


def main() -> NoReturn:
    """Read a notebook or judge an answer, write the message, and end at once: no code of the answer runs after that."""
    notebook, seconds, is_sandboxed, *exercise = sys.argv[1:]
    os.set_inheritable(int(notebook), False)
    report = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # where what an answer prints goes
    limit(int(seconds), is_sandboxed == "True")
    threading.Thread(target=_end_with_the_teacher, name="parent watch", daemon=True).start()
    known = {each.name: each for those in exercises().values() for each in those}
    answers, problem = _open(int(notebook), known)
    message = _judge(known[exercise[0]], answers[exercise[0]]) if exercise else Opened(list(answers), problem)
    with os.fdopen(report, "wb") as file:
        file.write(msgspec.json.encode(message) + b"\n")
    os._exit(0)


def _end_with_the_teacher() -> None:
    """Wait until the other end of stdin is closed: the teacher's process closes it, or has ended."""
    os.read(0, 1)
    os.killpg(0, signal.SIGKILL)
    os._exit(1)  # the sandbox's first process bears its own signals; when it ends, so do the others


def _open(notebook: int, known: Mapping[str, Exercise]) -> tuple[dict[str, Answer], str]:
    """Return the answers in a notebook, by their exercise, and what is wrong with the file; empty if nothing is."""
    try:
        with open(notebook, encoding="utf-8") as file:
            cells = cells_of(file.read())
        answers = find_answers(cells, {name: each.right_answer.__name__ for name, each in known.items()})
    except Exception as error:  # noqa: BLE001 - the file may be anything
        return {}, f"it is no notebook: {type(error).__name__}: {error}"
    return {answer.exercise: answer for answer in answers}, ""


def _judge(exercise: Exercise, answer: Answer) -> Judged:
    if answer.given is None:
        outcome = Outcome.WRONG if answer.unreadable else Outcome.NOT_TRIED
        return Judged(outcome, answer.unreadable, answer.unreadable)
    try:
        given = answer.define()
    except BaseException as error:  # noqa: BLE001 - it is a learner's code, which may call sys.exit
        text = f"The answer cannot be defined: {type(error).__name__}: {error}".removesuffix(": ")
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
