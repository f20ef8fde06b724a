"""Messages from the process that reads a notebook or judges an answer, each a line of JSON."""

from enum import StrEnum

import msgspec

from tutorial.errors import printable_lines

LONGEST = 4000  # maximum number of characters; longer strings are truncated
FORGED = "The answer made its process report 'right', but not in the check's format: inspect its code."


class Outcome(StrEnum):
    """The verdict on an answer."""

    RIGHT = "right"
    WRONG = "wrong"
    NOT_TRIED = "not tried"
    NOT_JUDGED = "not judged"


class Opened(msgspec.Struct):
    """The result of reading a notebook.

    Attributes:
        exercises: the notebook's exercises, in order.
        problem: why the notebook cannot be read; otherwise empty.
    """

    exercises: list[str]
    problem: str = ""

    def __post_init__(self) -> None:
        """Escape control characters, both in new messages and in received ones."""
        self.problem = clean(self.problem)[:200]


class Judged(msgspec.Struct):
    """The result of judging an answer.

    Attributes:
        outcome: the verdict.
        cause: if the answer is not right, the most likely cause, as a sentence.
        text: the text that a learner sees.
    """

    outcome: Outcome
    cause: str = ""
    text: str = ""

    def __post_init__(self) -> None:
        """Escape control characters, both in new messages and in received ones, and detect forged verdicts.

        A check's "right" verdict has ticks, no crosses and no cause. Any other "right" becomes "not judged".
        """
        self.cause, self.text = clean(self.cause), clean(self.text)
        marks = {line[:1] for line in self.text.split("\n")}
        if self.outcome is Outcome.RIGHT and (self.cause or "✓" not in marks or "✗" in marks):
            self.outcome, self.cause = Outcome.NOT_JUDGED, FORGED


def clean(text: str) -> str:
    """Escape invisible characters, which a terminal would interpret and XML forbids."""
    kept = printable_lines(text)
    return kept if len(kept) <= LONGEST else f"{kept[: LONGEST - 1]}…"
