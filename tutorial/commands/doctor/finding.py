"""What the doctor finds, and how that is put on a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

__all__ = ["Finding", "layout", "summary"]

Level = Literal["ok", "note", "problem"]

WIDTH = 100  # columns
INDENT = " " * 20
MEND = "-> "


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    Attributes:
        subject: what was looked at; at most 10 letters, for it stands in a column of its own.
        level: ``"ok"``; ``"note"``, where something may surprise; ``"problem"``, where something does not work.
        text: what there is.
        mend: what to type or to do; a note and a problem have one.
    """

    subject: str
    level: Level
    text: str
    mend: str = ""

    def __post_init__(self) -> None:
        if self.level != "ok" and not self.mend:
            raise ValueError(f"a {self.level} says its mend: {self.text!r} has none")


def layout(finding: Finding) -> str:
    """Put a finding into columns: subject, level, text; the mend stands below, behind an arrow.

    A word is never broken, so that paths and commands can be copied.
    """
    head = f"{finding.subject:<11}{finding.level:<9}"
    lines = _wrapped(finding.text, head, INDENT)
    if finding.mend:
        lines += _wrapped(finding.mend, INDENT + MEND, INDENT + " " * len(MEND))
    return "\n".join(lines)


def summary(findings: Iterable[Finding]) -> str:
    """Count the problems and notes in one line."""
    levels = [finding.level for finding in findings]
    counts = {level: levels.count(level) for level in ("problem", "note")}
    return ", ".join(f"{n or 'no'} {level}{'' if n == 1 else 's'}" for level, n in counts.items()) + "."


def _wrapped(text: str, first: str, others: str) -> list[str]:
    return textwrap.wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=others, break_long_words=False, break_on_hyphens=False
    )
