"""Cases and mistakes: the data of an exercise, which say what is tried and what is known of wrong answers.

For instance::

    MISTAKES = [
        Mistake("you add in place of multiplying.", replace("2 * x", "2 + x", "x + 2")),
        Mistake("you return before the end.", both(replace("return 2 * x", "pass"), replace("x = ", "return "))),
    ]
    CASES = [
        Case("a number below 0", lambda trial: trial.call(trial.answer, -2), "You probably forget the sign: keep it."),
    ]
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import chain, product
from typing import Any

from tutorial.checks.engine.trial import Trial

# Tries `trial.answer` and returns what it observes: numbers of about 1, texts, or lists or dicts of these.
Run = Callable[[Trial], Any]

CLOCK = "You probably ask the computer's clock. Only the simulated time that you are given counts."


@dataclass(frozen=True)
class Edit:
    """A change of a source: another text takes the place of a text, wherever that stands.

    Attributes:
        old: the text that is replaced.
        new: the text that takes its place. Its further lines are indented like the line in which `old` stands.
    """

    old: str
    new: str

    def made_in(self, source: str) -> str | None:
        """Return the source with this change; None if nothing in it can be changed."""
        before, is_there, _ = source.partition(self.old)
        margin = before.rpartition("\n")[2]
        indent = margin[: len(margin) - len(margin.lstrip())]
        return source.replace(self.old, self.new.replace("\n", f"\n{indent}")) if is_there else None


# Ways to make a mistake: each is the edits that have to be made together.
Ways = tuple[tuple[Edit, ...], ...]


def replace(old: str, *new: str) -> Ways:
    """Replace a part of the solution's source. Each replacement is a way of its own to make the mistake.

    Change as little as possible: two mistakes can only be found together if they change different texts. The new text
    may use what the exercise's module, `asyncio`, `functools`, `math` and `itertools` define.

    Args:
        old: the part. If it occurs several times, all of them are replaced.
        new: the replacements. Their further lines are indented like the line in which `old` stands.
    """
    return tuple((Edit(old, each),) for each in new)


def both(*ways: Ways) -> Ways:
    """Make several edits together, one after the other, for instance ``both(replace(...), replace(...))``.

    If one of them has several replacements, each combination is a way to make the mistake.
    """
    return tuple(tuple(chain(*each)) for each in product(*ways))


@dataclass(frozen=True)
class Fault:
    """A mistake that is made in one way.

    Attributes:
        cause: the cause that the learner reads, after "Most likely".
        edits: the changes of the solution's source, made one after the other.
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
    """A mistake, and all the ways in which it can be made.

    Attributes:
        cause: what the learner reads after "Most likely". It says what is wrong, and then what to do.
        ways: how the solution's source has to be edited for the same mistake: `replace(...)`, `both(...)`, or several
            of these with ``+`` in between.

    Raises:
        ValueError: there is no edit.
    """

    cause: str
    ways: Ways

    def __post_init__(self) -> None:
        if not self.ways or not all(self.ways):
            raise ValueError(f"the mistake has no edit: {self.cause!r}. Give it one: replace(old, new).")

    def faults(self) -> list[Fault]:
        """Return the ways to make it, each by itself."""
        return [Fault(self.cause, edits) for edits in self.ways]


@dataclass(frozen=True)
class Case:
    """One thing that an answer is tried in.

    Attributes:
        label: what is tried, as the learner reads it. No two cases have the same.
        run: tries the answer and returns what it observes. The solution's observation is the expected one.
        meaning: the most likely cause if the observation is wrong and no known mistake explains it, as a sentence;
            by default `Cases.meaning`.
        crashes: whether `meaning` also explains an exception, because the case gives something that is missing or
            unusual.
    """

    label: str
    run: Run
    meaning: str = ""
    crashes: bool = False


@dataclass(frozen=True, eq=False)
class Cases:
    """Everything that an exercise tries, and what it knows of wrong answers.

    Numbers within 1e-4 of each other count as equal.

    Attributes:
        solution: the right answer. What is observed of it is what is expected.
        cases: what an answer is tried in, in this order.
        mistakes: the known mistakes, the root causes first.
        meaning: the most likely cause of a wrong observation whose case has no meaning of its own, as a sentence.
        say: puts an observation into words.
        beside: functions of the solution's module that a mistake may change, too.
        clock: the cause of a wrong observation if the answer asks the computer's clock; "" if it may ask it.
        on_ros: tries a right answer with rclpy's own node, and says what it observes.
        one_by_one: whether the first wrong observation ends the check.
    """

    solution: Any
    cases: Sequence[Case]
    mistakes: Sequence[Mistake]
    meaning: str
    say: Callable[[Any], str] = str
    beside: Sequence[Any] = ()
    clock: str = CLOCK
    on_ros: Run | None = None
    one_by_one: bool = False

    def meaning_of(self, case: Case) -> str:
        """Return the most likely cause of a wrong observation in a case."""
        return case.meaning or self.meaning

    @property
    def faults(self) -> list[Fault]:
        """All known mistakes, each in each of its ways, the root causes first."""
        return [fault for mistake in self.mistakes for fault in mistake.faults()]
