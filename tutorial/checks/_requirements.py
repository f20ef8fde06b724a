"""Exercises about what is displayed: a list of requirements, each with the mistakes that fail it."""

from __future__ import annotations

import dis
import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tutorial.checks._cases import observed, same
from tutorial.checks._mistakes import Mistake, mistakes, with_mistakes
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Failure, files_of, watch
from tutorial.errors import TutorialError

__all__ = ["Requirement", "Requirements", "listed"]

THROTTLED = "Most likely messages are dropped by time or by count: post and show every one, whenever it comes."


@dataclass(frozen=True)
class Requirement:
    """One thing that is asked for.

    Attributes:
        text: what is tried, as the learner is told.
        attempt: tries it; a function of the answer that returns what is observed, in words.
        expected: what is to be observed.
        mistakes: those that fail it. The first one's cause is named where no other leads to exactly what was observed.
            Empty where whatever fails it has its cause with it, as a `Misuse` has.
    """

    text: str
    attempt: Callable[[Any], str]
    expected: str
    mistakes: Sequence[Mistake]


@dataclass(frozen=True)
class Requirements:
    """What an answer has to do, one thing after the other.

    Attributes:
        solution: the right answer, whose source the mistakes change.
        each: the requirements, in the order in which they are tried; the first that is not met ends it.
        clock: the cause to name where the computer's clock is asked; "" where that may be right.
        on_ros: tries a right answer with rclpy's own node, and says what comes of it.
        odd: exceptions that odd messages lead to: a requirement's cause is named. Any other speaks for itself.
    """

    solution: type
    each: Sequence[Requirement]
    clock: str = THROTTLED
    odd: tuple[type[Exception], ...] = (LookupError, ValueError, ArithmeticError, TutorialError)
    on_ros: Callable[[Any], str] | None = None

    def judge(self, answer: type) -> Iterator[Finding]:
        """Try an answer, and say of each requirement what was observed."""
        shared = SharedState(answer)
        for one in self.each:
            with watch.clocks_stand():
                seen = observed(one.attempt, answer)
            if isinstance(seen, Failure):
                cause = self._cause(one, seen, shared) if isinstance(seen.error, self.odd) else None
                yield seen.finding(cause, one.text)
                return
            if seen != one.expected:
                text, place = f"{one.text}: {seen}; expected: {one.expected}", next(iter(watch.noted.values()), None)
                by_the_clock = self.clock if "clock" in watch.noted else ""
                yield wrong(text, by_the_clock or self._cause(one, seen, shared), place)
                return
            yield right(f"{one.text}: {seen}")
        if self.on_ros:
            yield right(f"with another program: {self.on_ros(answer)}")

    def mistaken(self, mistake: Mistake) -> Any:
        """Define the solution with a mistake in it."""
        return with_mistakes(self.solution, [mistake])

    def _cause(self, one: Requirement, seen: Any, shared: SharedState) -> str:
        """Name the mistake that leads to what was observed."""
        watch.explaining = True
        first, *others = one.mistakes
        found = next((each for each in others if same(self._seen_of(one, each), seen)), None)
        cause = f"Most likely {(found or first).cause}"
        proposed = re.search(r"(\w+)\([^()]*\) is missing, or", cause)
        if proposed and proposed[1] in _calls(watch.answer):  # it is there
            cause = cause.replace(" is missing, or", " is", 1)
        return cause if found and "." not in shared.changed() else shared.cause(cause)

    def _seen_of(self, one: Requirement, mistake: Mistake) -> Any:
        """Observe the solution with a mistake in it."""
        twin = self.mistaken(mistake)
        watch.files |= files_of(twin)
        watch.noted.clear()
        with watch.clocks_stand():
            return observed(one.attempt, twin)


def listed(tried: Mapping[str, tuple[Callable[[Any], str], str]], table: str) -> tuple[Requirement, ...]:
    """List requirements.

    Args:
        tried: by text, what is tried and what is expected.
        table: the mistakes of all of them, each requirement's below a line with ``#`` and its text.
    """
    _, *parts = re.split(r"^# (.*)$", table, flags=re.MULTILINE)
    known = {text: mistakes(each) for text, each in zip(parts[::2], parts[1::2])}
    return tuple(Requirement(text, *asked, known.get(text, ())) for text, asked in tried.items())


def _calls(answer: Any) -> set[str]:
    """Return the names that a class's methods use; what posts is only kept in `configure`."""
    return {
        str(each.argval)
        for method, function in inspect.getmembers(answer, inspect.isfunction)
        for each in dis.get_instructions(function)
        if not (method == "configure" and str(each.argval).startswith("call_"))
    }
