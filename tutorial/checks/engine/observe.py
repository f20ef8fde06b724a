"""Observe: try an answer in all cases, and collect the observations."""

import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from math import isclose, isnan
from numbers import Real
from typing import Any

from tutorial.checks.engine.answer import files_of, name_of
from tutorial.checks.engine.cases import Case, Cases, Run
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.shared_state import SharedState
from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.verdict import Place

TOLERANCE = 1e-4
UNLIKE = (
    "Your code probably produces a value of the wrong type, "
    "such as a number or an array instead of a list or a message."
)


@dataclass(frozen=True, eq=False)
class Observation:
    """An answer's result in one case.

    Attributes:
        case: the case.
        value: the answer's result in the case, or the `Failure` that ended the case.
        expected: the solution's result in the case.
        seconds: how long the solution took [s]. The answer can take longer if it has to compile a model first.
        noted: how the answer used time and threads, as in `Trial.noted`.
    """

    case: Case
    value: Any
    expected: Any
    seconds: float = 0.0
    noted: Mapping[str, Place | None] = field(default_factory=dict)

    @property
    def is_odd(self) -> bool:
        """Whether the answer's result differs from the solution's result."""
        return not same(self.value, self.expected)

    @property
    def failed(self) -> bool:
        """Whether the answer raised an exception, or did something that cannot work."""
        return isinstance(self.value, Failure)

    @property
    def is_misuse(self) -> bool:
        """Whether the answer did something that cannot work."""
        return isinstance(self.value, Failure) and self.value.is_misuse


@dataclass(frozen=True)
class Observations:
    """All observations of an answer.

    Attributes:
        all: one observation per case, in the order of the trials. The check may have ended before the last case.
        changed: the name of a shared object that the trials have changed, as `SharedState.changed` returns it.
    """

    all: tuple[Observation, ...]
    changed: str = ""

    @property
    def odd(self) -> list[Observation]:
        """The observations that differ from the expected ones."""
        return [each for each in self.all if each.is_odd]

    def place_of(self, what: str) -> Place | None:
        """Return where the answer first used something (such as ``"clock"``) in a case with an unexpected result."""
        return next((each.noted[what] for each in self.odd if what in each.noted), None)


def observe(
    cases: Cases, answer: Any, begin: Callable[[Any, Collection[str]], Trial], expected: Callable[[Case], Any]
) -> Observations:
    """Try an answer in one case after another, until the remaining cases would reveal nothing more.

    Args:
        cases: the cases.
        answer: the learner's class or function.
        begin: begins a trial, given the answer and the files whose code is watched.
        expected: returns the solution's result in a case.
    """
    shared, seen = SharedState(answer), list[Observation]()
    watched = files_of(answer)  # first, because running the answer can add functions from other files to its class
    for case in cases.cases:
        trial = begin(answer, watched)
        value, began = attempt(case.run, trial), time.monotonic()
        wanted = expected(case)
        seen.append(Observation(case, value, wanted, time.monotonic() - began, dict(trial.noted)))
        if seen[-1].is_misuse or (cases.one_by_one and seen[-1].is_odd):
            break
    return Observations(tuple(seen), shared.changed())


def attempt(run: Run, trial: Trial) -> Any:
    """Run a case, and return its observation, or the failure that ended the case."""
    try:
        return run(trial)
    except Failure as failure:
        return failure
    except Exception as error:  # noqa: BLE001 - an odd answer can cause any exception
        text = f"the check cannot read the answer's result: {type(error).__name__}: {error}"
        return Failure(name_of(trial.answer), error if isinstance(error, Misuse) else Misuse(text, UNLIKE))


def same(a: Any, b: Any) -> bool:
    """Return whether two observations are equal, ignoring rounding errors and the line numbers of failures."""
    match a, b:
        case Failure(), Failure():
            return bool(a.kind == b.kind)
        case Mapping(), Mapping():
            return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
        case ((list() | tuple()), (list() | tuple())):
            return len(a) == len(b) and all(map(same, a, b))
        case Real(), Real():
            return isclose(a, b, rel_tol=TOLERANCE, abs_tol=TOLERANCE) or (isnan(a) and isnan(b))
    return bool(a == b)
