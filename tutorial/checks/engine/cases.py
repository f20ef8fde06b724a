"""Cases and mistakes: the data of an exercise. Cases define what to try; mistakes describe common wrong answers.

For instance::

    MISTAKES = [
        Mistake("your code adds instead of multiplying.", replace("2 * x", "2 + x", "x + 2")),
        Mistake("your code returns before the end.", both(replace("return 2 * x", "pass"), replace("x = ", "return "))),
    ]
    CASES = [
        Case("a number below 0", lambda trial: trial.call(trial.answer, -2),
             "Your code probably drops the sign. Keep it."),
    ]
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain, product
from typing import Any

from tutorial.checks.engine.trial import Trial

# Tries `trial.answer` and returns an observation: a number of order 1, a string, or a list or dict of these.
Run = Callable[[Trial], Any]

CLOCK = "Your code probably reads the computer's clock. Use only the time that your code receives."


@dataclass(frozen=True)
class Edit:
    """A change to source code: every occurrence of a string is replaced.

    Attributes:
        old: the string to replace.
        new: the replacement. Its second and later lines are indented like the line that contains `old`.
    """

    old: str
    new: str

    def made_in(self, source: str) -> str | None:
        """Return the source with this change; None if the source does not contain the old text."""
        before, is_there, _ = source.partition(self.old)
        margin = before.rpartition("\n")[2]
        indent = margin[: len(margin) - len(margin.lstrip())]
        return source.replace(self.old, self.new.replace("\n", f"\n{indent}")) if is_there else None


# Mistakes: each is a group of edits that belong together.
Ways = tuple[tuple[Edit, ...], ...]


def replace(old: str, *new: str) -> Ways:
    """Replace a part of the solution's source. Each replacement is a separate way to make the mistake.

    Change as little as possible: two mistakes can only be found together if they change different parts of the source.
    The new text can use any name in the namespace of the exercise's module, `asyncio`, `functools`, `math` or
    `itertools`.

    Args:
        old: the part to replace. All its occurrences are replaced.
        new: the replacements. Their second and later lines are indented like the line that contains `old`.
    """
    return tuple((Edit(old, each),) for each in new)


def both(*ways: Ways) -> Ways:
    """Combine several edits, applied one after another, for instance ``both(replace(...), replace(...))``.

    If an edit has several replacements, each combination is a separate way to make the mistake.
    """
    return tuple(tuple(chain(*each)) for each in product(*ways))


@dataclass(frozen=True)
class Fault:
    """One way to make a mistake.

    Attributes:
        cause: the cause that the learner reads after "Most likely".
        edits: the changes to the solution's source, in order.
    """

    cause: str
    edits: tuple[Edit, ...]

    def made_in(self, source: str) -> str | None:
        """Return the source with the mistake; None if an edit finds nothing to change."""
        changed: str | None = source
        for edit in self.edits:
            changed = changed and edit.made_in(changed)
        return changed


@dataclass(frozen=True)
class Mistake:
    """A mistake, and all known ways to make it.

    Attributes:
        cause: the cause that the learner reads after "Most likely": what is wrong, and then what to do.
        ways: the edits to the solution's source that lead to this mistake: `replace(...)`, `both(...)`, or several of
            these, joined by ``+``.

    Raises:
        ValueError: no edits are given.
    """

    cause: str
    ways: Ways

    def __post_init__(self) -> None:
        if not self.ways or not all(self.ways):
            raise ValueError(f"the mistake has no edit: {self.cause!r}. Give it one: replace(old, new).")

    def faults(self) -> list[Fault]:
        """Return a `Fault` for each way to make the mistake."""
        return [Fault(self.cause, edits) for edits in self.ways]


@dataclass(frozen=True)
class Case:
    """One situation that an answer has to handle.

    Attributes:
        label: the situation, as the learner reads it. No two cases have the same label.
        run: tries the answer and returns an observation. The solution's observation is the expected one.
        meaning: the most likely cause of a wrong observation that no known mistake explains, as a sentence; by
            default `Cases.meaning`.
        crashes: whether `meaning` also explains an exception, because the input of the case is unusual or incomplete.
    """

    label: str
    run: Run
    meaning: str = ""
    crashes: bool = False


@dataclass(frozen=True, eq=False)
class Cases:
    """The cases, the known mistakes and the solution of an exercise.

    Numbers within 1e-4 of each other count as equal.

    Attributes:
        solution: the right answer. Its observations are the expected ones.
        cases: the cases, in the order they run.
        mistakes: the known mistakes, root causes first.
        meaning: the most likely cause of a wrong observation in a case that defines no meaning, as a sentence.
        describe: describes an observation.
        beside: functions of the solution's module that mistakes can also change.
        clock: the cause of a wrong observation if the answer reads the computer's clock; "" if answers may read the
            clock.
        on_ros: tries a right answer on rclpy's own node and describes the result.
        one_by_one: whether the first wrong observation stops the check.
    """

    solution: Any
    cases: Sequence[Case]
    mistakes: Sequence[Mistake]
    meaning: str
    describe: Callable[[Any], str] = str
    beside: Sequence[Any] = ()
    clock: str = CLOCK
    on_ros: Run | None = None
    one_by_one: bool = False

    def meaning_of(self, case: Case) -> str:
        """Return the most likely cause of a wrong observation in a case."""
        return case.meaning or self.meaning

    @property
    def faults(self) -> list[Fault]:
        """All ways to make the known mistakes, root causes first."""
        return [fault for mistake in self.mistakes for fault in mistake.faults()]
