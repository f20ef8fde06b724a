"""Known mistakes: edits of a solution's source, each with the cause that it is told as."""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import Any

__all__ = ["Mistake", "mistakes", "with_mistakes"]

NEW_LINE = " // "


@dataclass(frozen=True)
class Mistake:
    """A way to be wrong.

    Attributes:
        cause: what names it, after the words "Most likely".
        edits: what in the solution's source is replaced, and by what: all that is like it, one after the other.
    """

    cause: str
    edits: tuple[tuple[str, str], ...]

    def made_in(self, source: str) -> str | None:
        """Return the source with the mistake; None for one without what it changes."""
        for old, new in self.edits:
            if old not in source:
                return None
            line = next(line for line in source.splitlines() if old in line)
            indent = line[: len(line) - len(line.lstrip())]
            source = source.replace(old, new.replace(NEW_LINE, f"\n{indent}"))
        return source


def mistakes(table: str) -> tuple[Mistake, ...]:
    """Read mistakes, the root causes first.

    Args:
        table: one block for each mistake. Its cause stands at the margin. Below it stand its edits, indented, one a
            line: ``what => what instead``. A `` // `` in an edit begins a new line, indented as the changed one.
            ``what => this => that`` makes two mistakes with the same cause; the next line may go on with ``=>``. Change
            as little as possible: two mistakes that change the same text cannot be found together.

    Raises:
        ValueError: a cause has no edit below it, or an edit no cause.
    """
    lines = re.sub(r"\n +=>", " =>", inspect.cleandoc(table)) + "\n"
    block = r"((?:^\S.*\n)+)((?:^ .*=>.*\n)+)"
    left = re.sub(block, "", lines, flags=re.MULTILINE).strip()
    if left:
        raise ValueError(f"this is no cause with its edits below it, indented, what => what instead: {left}")
    blocks = re.findall(block, lines, re.MULTILINE)
    return tuple(
        Mistake(" ".join(cause.split()), chosen)
        for cause, edits in blocks
        for chosen in product(*map(_edits, edits.splitlines()))
    )


def _edits(line: str) -> list[tuple[str, str]]:
    old, *new = line.split("=>")
    return [(old.strip(), each.strip()) for each in new]


def with_mistakes(solution: Any, chosen: Sequence[Mistake], beside: Sequence[Any] = ()) -> Any:
    """Define a solution with mistakes in it; None where one leaves nothing for another to change.

    Args:
        solution: the right answer.
        chosen: the mistakes.
        beside: functions of the solution's module that a mistake may change, too.
    """
    source: str | None = _source((*beside, solution))
    for mistake in chosen:
        source = source and mistake.made_in(source)
    if source is None:
        return None
    names = dict(vars(sys.modules[solution.__module__]))
    exec(compile(source, "<a mistake>", "exec"), names)
    return names[solution.__name__]


@cache
def _source(parts: tuple[Any, ...]) -> str:
    return "\n\n".join(map(inspect.getsource, parts))
