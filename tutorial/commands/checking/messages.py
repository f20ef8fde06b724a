"""Messages from the process that reads a notebook, or judges an answer, to the teacher's: one line of JSON each."""

from enum import StrEnum

import msgspec

from tutorial.errors import printable_lines

LONGEST = 4000  # characters of a text that is told
FORGED = "The answer has the process that judged it say 'right', and not as the check does: look at what it does."


class Outcome(StrEnum):
    """What became of an answer."""

    RIGHT = "right"
    WRONG = "wrong"
    NOT_TRIED = "not tried"
    NOT_JUDGED = "not judged"


class Opened(msgspec.Struct):
    """The notebook is read.

    Attributes:
        exercises: those that it has, in its order.
        problem: why it cannot be read; else empty.
    """

    exercises: list[str]
    problem: str = ""

    def __post_init__(self) -> None:
        """Escape what a terminal would obey, in a message made here and in one that was read."""
        self.problem = clean(self.problem)[:200]


class Judged(msgspec.Struct):
    """An answer was judged.

    Attributes:
        outcome: what became of it.
        cause: for one that is not right, the most likely cause, as a sentence.
        text: what a learner sees.
    """

    outcome: Outcome
    cause: str = ""
    text: str = ""

    def __post_init__(self) -> None:
        """Escape what a terminal would obey, in a message made here and in one that was read.

        A check that says "right" has a tick for what it has seen, no cross, and no cause: what has not is not judged.
        """
        self.cause, self.text = clean(self.cause), clean(self.text)
        marks = {line[:1] for line in self.text.split("\n")}
        if self.outcome is Outcome.RIGHT and (self.cause or "✓" not in marks or "✗" in marks):
            self.outcome, self.cause = Outcome.NOT_JUDGED, FORGED


def clean(text: str) -> str:
    """Write invisible characters as escapes: a terminal would obey them, and XML forbids them."""
    kept = printable_lines(text)
    return kept if len(kept) <= LONGEST else f"{kept[: LONGEST - 1]}…"
