"""Messages from the process that reads a notebook or judges an answer, each sent as one line of JSON."""

from enum import StrEnum

import msgspec

from tutorial.errors import printable_lines

LONGEST = 4000  # maximum number of characters; longer strings are truncated
FORGED = "The verdict is not in the check's format, so the answer may have forged it: inspect the answer's code."


class Outcome(StrEnum):
    """The verdict on an answer."""

    RIGHT = "right"
    WRONG = "wrong"
    NOT_TRIED = "not tried"
    NOT_JUDGED = "not judged"
    SCORED = "scored"


class Opened(msgspec.Struct):
    """The result of reading a notebook.

    Attributes:
        exercises: the notebook's exercises, in order.
        problem: why the notebook cannot be read; otherwise empty.
        driver: the program for the race; empty if the notebook has none.
    """

    exercises: list[str]
    problem: str = ""
    driver: str = ""

    def __post_init__(self) -> None:
        """Escape control characters, both in new messages and in received ones."""
        self.problem = clean(self.problem)[:200]


class Judged(msgspec.Struct):
    """The result of judging an answer.

    Attributes:
        outcome: the verdict.
        cause: if the answer is not right, the most likely cause, as a sentence.
        text: the text that a learner sees.
        score: the points scored in a race, from 0 to 100; None if there was no race.
    """

    outcome: Outcome
    cause: str = ""
    text: str = ""
    score: float | None = None

    def __str__(self) -> str:
        """Return the verdict as the table shows it, such as ``right`` or ``43.2 points``."""
        return self.outcome if self.score is None else f"{self.score:.1f} points"

    def __post_init__(self) -> None:
        """Escape control characters, both in new messages and in received ones, and detect forged verdicts.

        A check's "right" verdict has ticks, no crosses and no cause. Any other "right" verdict becomes "not judged".
        """
        self.cause, self.text = clean(self.cause), clean(self.text)
        marks = {line[:1] for line in self.text.split("\n")}
        if self.outcome is Outcome.RIGHT and (self.cause or "✓" not in marks or "✗" in marks):
            self.outcome, self.cause = Outcome.NOT_JUDGED, FORGED


def clean(text: str) -> str:
    """Escape invisible characters: a terminal would interpret them, and XML forbids them."""
    kept = printable_lines(text)
    return kept if len(kept) <= LONGEST else f"{kept[: LONGEST - 1]}…"
