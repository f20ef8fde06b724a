"""Which mistakes explain what was seen: models of wrong answers, tried from the likeliest on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import isclose, isnan
from typing import Any

from tutorial.checks._verdict import Finding, right, wrong

__all__ = ["Mistake", "Probe", "explain", "judge_probes"]

TOLERANCE = 1e-4
MOST = 2  # mistakes at once; three of them look like too much else


@dataclass(frozen=True)
class Mistake:
    """A way to be wrong.

    Attributes:
        part: which part of the model it changes.
        value: what it changes that to.
        cause: what names it, after the words "Most likely".
    """

    part: str
    value: Any
    cause: str


@dataclass(frozen=True)
class Probe:
    """One thing that was tried, and what came of it.

    Attributes:
        label: what was tried.
        seen: the numbers that came of it.
        say: puts such numbers into words.
        want: puts those that were expected into words, in short; None for `say`.
        otherwise: the cause to name when this is the first that is wrong, and no mistakes that are known explain it.
    """

    label: str
    seen: tuple[float, ...]
    say: Callable[[tuple[float, ...]], str]
    want: Callable[[tuple[float, ...]], str] | None = None
    otherwise: str = ""


Predict = Callable[..., Iterable[tuple[float, ...]]]


def explain(
    seen: Sequence[tuple[float, ...]], predict: Predict, mistakes: Sequence[Mistake]
) -> tuple[Mistake, ...] | None:
    """Find the fewest mistakes that lead to exactly what was seen.

    Args:
        seen: the numbers of each probe.
        predict: the model, ``predict(**{part: value})``; without arguments it is the right answer.
        mistakes: those to try, the root causes first.

    Returns:
        The mistakes, none for the right answer; None when nothing that is known explains it.
    """
    for count in range(MOST + 1):
        for chosen in combinations(mistakes, count):
            parts = {mistake.part: mistake.value for mistake in chosen}
            if len(parts) == count and all(map(_same, predict(**parts), seen)):  # predicts as far as it agrees
                return chosen
    return None


def judge_probes(
    probes: Sequence[Probe], predict: Predict, mistakes: Sequence[Mistake], otherwise: str
) -> Iterator[Finding]:
    """Say of each probe whether it was right, and name the mistakes where they show first.

    Args:
        probes: what was tried.
        predict, mistakes: as for `explain`.
        otherwise: the cause to name when no mistakes that are known explain what was seen.
    """
    expected = list(predict())
    found = explain([probe.seen for probe in probes], predict, mistakes)
    causes = {} if found is None else _first_shown(probes, expected, predict, found)
    first = next((probe for probe, wanted in zip(probes, expected) if not _same(probe.seen, wanted)), None)
    otherwise = (first and first.otherwise) or otherwise
    for i, (probe, wanted) in enumerate(zip(probes, expected)):
        if _same(probe.seen, wanted):
            yield right(f"{probe.label}: {probe.say(probe.seen)}")
        elif found is None or i in causes:
            expects = (probe.want or probe.say)(wanted)
            text = f"{probe.label}: {probe.say(probe.seen)}; expected: {expects}"
            yield wrong(text, causes.get(i, otherwise))


def _first_shown(
    probes: Sequence[Probe], expected: Sequence[tuple[float, ...]], predict: Predict, found: Sequence[Mistake]
) -> dict[int, str]:
    """Map probes to the causes that they show; each cause is shown by the first probe that it makes wrong."""
    causes: dict[int, str] = {}
    wrong_ones = [i for i, probe in enumerate(probes) if not _same(probe.seen, expected[i])]
    for mistake in found:
        alone = list(predict(**{mistake.part: mistake.value}))
        shows = [i for i in wrong_ones if i not in causes]
        best = next((i for i in shows if not _same(alone[i], expected[i])), shows[0] if shows else None)
        if best is not None:
            causes[best] = f"Most likely {mistake.cause}"
    return causes


def _same(a: tuple[float, ...], b: tuple[float, ...]) -> bool:
    return len(a) == len(b) and all(map(_near, a, b))


def _near(x: float, y: float) -> bool:
    return isclose(x, y, rel_tol=TOLERANCE, abs_tol=TOLERANCE) or (isnan(x) and isnan(y))
