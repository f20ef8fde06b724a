"""What the process that judges a notebook tells the teacher's, a line of JSON each."""

from __future__ import annotations

from enum import StrEnum

import msgspec

__all__ = ["LONGEST", "Done", "Judged", "Message", "Opened", "Outcome", "Trying", "Unreadable", "clean"]

LONGEST = 4000  # characters of a text that is told


class Outcome(StrEnum):
    """What became of an answer."""

    RIGHT = "right"
    WRONG = "wrong"
    NOT_TRIED = "not tried"
    NOT_JUDGED = "not judged"


class Opened(msgspec.Struct, frozen=True, tag=True):
    """The notebook is read: which exercises it has."""

    exercises: tuple[str, ...]


class Unreadable(msgspec.Struct, tag=True):
    """It is none that can be read, and why."""

    why: str

    def __post_init__(self) -> None:
        """Bring in nothing that a terminal would obey, made here or read."""
        self.why = clean(self.why)[:200]


class Trying(msgspec.Struct, frozen=True, tag=True):
    """An answer is about to be run."""

    exercise: str


class Judged(msgspec.Struct, tag=True):
    """An answer was judged.

    Attributes:
        exercise: the exercise's name.
        outcome: what became of it.
        cause: for one that is not right, the most likely cause, as a sentence.
        text: what a learner sees.
    """

    exercise: str
    outcome: Outcome
    cause: str = ""
    text: str = ""

    def __post_init__(self) -> None:
        """Bring in nothing that a terminal would obey, made here or read."""
        self.cause, self.text = clean(self.cause), clean(self.text)


class Done(msgspec.Struct, frozen=True, tag=True):
    """There is no more."""


Message = Opened | Unreadable | Trying | Judged | Done


def clean(text: str) -> str:
    """Take from a text what is no character to be read: a terminal would obey it, and XML has no place for it."""
    kept = "".join(c if c.isprintable() or c == "\n" else "\N{REPLACEMENT CHARACTER}" for c in text)
    return kept if len(kept) <= LONGEST else f"{kept[: LONGEST - 1]}…"
