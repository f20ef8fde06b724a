"""What is wrong with an answer: it does in every case what the solution does with one or two known mistakes in it."""

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass
from functools import cache, cached_property
from io import StringIO
from itertools import chain, combinations
from math import isclose, isnan
from numbers import Real
from typing import Any

from tutorial.checks._answer import name_of
from tutorial.checks._mistakes import Mistake, another, missing, read, slips, with_mistakes
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Failure, Misuse, watch
from tutorial.errors import TutorialError

TOLERANCE = 1e-4
LONGEST = 20.0  # [s] in which mistakes are tried, one and two at once; so that a busy machine comes to an end, too
CRASHES = (LookupError, ValueError, ArithmeticError, TypeError, TutorialError, UnboundLocalError)
CHANGED = "Most likely sort, reverse, pop, del, append, += or = did it: make one of your own; np.asarray makes none."
UNLIKE = "Most likely something has the wrong type, such as a number or an array in place of a list or a message."
CLOCK = "Most likely the computer's clock is asked: what counts is the time that is given."

Case = Callable[[Any], Any]


@dataclass(frozen=True, eq=False)
class Cases:
    """What an answer is tried in, and what it may have done instead.

    Numbers that are within 1e-4 of each other are the same, so let a case return numbers about 1, or a text.

    Attributes:
        solution: the right answer. What is observed of it is what is expected.
        cases: by what is tried, as the learner is told, a function that is given an answer and returns what is
            observed. It may raise `Failure`, which is an observation, too.
        table: what is known of mistakes, as `read` reads it. Of the parts of a case's text that it speaks of, the
            longest counts.
        say: puts an observation into words.
        crashes: parts of the texts of cases. It is the cause, too, that what they give, or None, cannot be computed
            with.
        beside: functions of the solution's module that a mistake may change, too.
        clock: the cause to name of an answer that asks the computer's clock, or the case's text that has it in the
            table; "" where that may be right.
        on_ros: tries a right answer with rclpy's own node, and says what comes of it.
        one_by_one: whether the first case that shows something else than is expected ends it.
    """

    solution: Any
    cases: Mapping[str, Case]
    table: str
    say: Callable[[Any], str]
    crashes: Sequence[str] = ()
    beside: Sequence[Any] = ()
    clock: str = CLOCK
    on_ros: Case | None = None
    one_by_one: bool = False

    def judge(self, answer: Any) -> Iterator[Finding]:
        """Try an answer, say of each case what was observed, and name each mistake where it shows first."""
        shared, seen, took = SharedState(answer), dict[str, Any](), dict[str, float]()
        for label, case in self.cases.items():
            began = time.monotonic()
            seen[label] = each = observed(case, answer)
            took[label] = time.monotonic() - began
            is_misuse = isinstance(each, Failure) and isinstance(each.error, Misuse)
            if is_misuse or (self.one_by_one and self._odd(seen)):
                break
        odd = self._odd(seen)
        by_the_clock = (self.clock and self.otherwise.get(self.clock, self.clock)) * ("clock" in watch.noted)
        place = watch.noted["clock"] if by_the_clock else None
        watch.explaining = True
        found, aside = ((), []) if by_the_clock else self._explained(seen, took)
        causes = self._shown(found, [label for label in odd if label not in aside])
        is_shared = "." in shared.changed()
        for label in seen:
            unknown, is_failure = by_the_clock or self._otherwise(label), isinstance(seen[label], Failure)
            if label not in odd:
                yield right(f"{label}: {self.say(seen[label])}")
            elif label in aside and any(not same(_alone(self, label, each), self.expected[label]) for each in found):
                continue
            elif label in aside and is_failure:
                error = seen[label].error
                crashed = isinstance(error, CRASHES) or "NoneType" in str(error)
                is_known = crashed and unknown != self.otherwise[""] and any(part in label for part in self.crashes)
                yield seen[label].finding(unknown if is_known else None, label)
                return
            elif label in causes or label in aside or (not found and label == odd[0]):
                cause = causes.get(label, unknown)
                cause = cause if label in causes and not is_shared else shared.cause(cause)
                if is_failure:
                    yield seen[label].finding(cause, label)
                else:
                    text = f"{label}: {self.say(seen[label])}; expected: {self.say(self.expected[label])}"
                    yield wrong(text, cause, place)
        if self.on_ros and not odd:
            yield right(f"with another program: {self.on_ros(answer)}")

    def _odd(self, seen: Mapping[str, Any]) -> list[str]:
        return [label for label in seen if not same(seen[label], self.expected[label])]

    def _explained(self, seen: Mapping[str, Any], took: Mapping[str, float]) -> tuple[Sequence[Mistake], Sequence[str]]:
        """Find mistakes that explain what was observed, but for cases that speak for themselves; return these, too."""
        failures = [label for label, each in seen.items() if isinstance(each, Failure)]
        misused = [label for label in failures if isinstance(seen[label].error, Misuse)]
        by_text: dict[str, list[str]] = {self.otherwise[""]: []}
        for label in self._odd(seen):
            by_text.setdefault(self._otherwise(label), []).append(label)
        _, *said = by_text.values()
        for aside in dict.fromkeys(map(tuple, ([], misused, failures, *said))):
            rest = {label: each for label, each in seen.items() if label not in aside}
            found = self.explain(rest, took, 1 if [*aside] in said else 2)
            if found:
                return found, aside
        return (), failures

    def explain(self, seen: Mapping[str, Any], took: Mapping[str, float], most: int = 2) -> tuple[Mistake, ...]:
        """Find the fewest mistakes, one or two, that lead to exactly what was observed; none where nothing known does.

        Slips are left alone where one case alone is odd, or one raises. Of an answer that raises in the first case, or
        was tried in few of them, two mistakes at once would only be guessed. A case that took long is tried last, as
        ``took`` says [s], and what is odd rather first: most likely a mistake does something else there.
        """
        raises = [isinstance(each, Failure) for each in seen.values()]
        odd = self._odd(seen)
        if not odd:
            return ()
        at, quickest = odd[-1], sorted(seen, key=lambda label: took[label] * (1 if label in odd else 2))
        known = [each for each in self.mistakes if each.fails in ("", at) or not self.one_by_one]
        has_slips = not any(raises) and len(odd) > 1
        known += slips(missing, self.solution, self.beside) if has_slips else ()
        shows = {each for each in known if not same(_alone(self, at, each), self.expected[at])}
        leads = {each for each in known if same(_alone(self, at, each), seen[at])}
        both = (two for two in combinations(known, 2) if shows.issuperset(two) or not leads.isdisjoint(two))
        tries = chain(
            ((each,) for each in known if each in leads),
            ((each,) for each in (slips(another, self.solution, self.beside) if has_slips else ())),
            () if most == 1 or raises[0] or self.one_by_one or 2 * len(seen) < len(self.cases) else both,
        )
        end = time.monotonic() + LONGEST
        for chosen in tries:
            if time.monotonic() > end:
                break
            twin = self.mistaken(*chosen)
            if twin and all(same(observed(self.cases[each], twin), seen[each]) for each in quickest):
                return chosen
        return ()

    def mistaken(self, *chosen: Mistake) -> Any:
        """Define the solution with mistakes in it; None where one leaves nothing for another to change."""
        return with_mistakes(self.solution, chosen, self.beside)

    @cached_property
    def expected(self) -> dict[str, Any]:
        """By case, what is observed of the solution."""
        return {label: case(self.solution) for label, case in self.cases.items()}

    @cached_property
    def mistakes(self) -> tuple[Mistake, ...]:
        """Those that are known, the root causes first."""
        return read(self.table)[0]

    @cached_property
    def otherwise(self) -> dict[str, str]:
        """The cause to name where no known mistakes explain what is observed, by a part of the case's text."""
        return read(self.table)[1]

    def _otherwise(self, label: str) -> str:
        return self.otherwise[max((part for part in self.otherwise if part in label), key=len)]

    def _shown(self, found: Sequence[Mistake], odd: Sequence[str]) -> dict[str, str]:
        """By case, the cause that it shows; each is shown by the first case that it makes wrong by itself."""
        causes: dict[str, str] = {}
        for mistake in found:
            free = [label for label in odd if label not in causes]
            shows = (label for label in free if not same(_alone(self, label, mistake), self.expected[label]))
            if free:
                causes[next(shows, free[0])] = f"Most likely {mistake.cause}"
        return causes


@cache
def _alone(cases: Cases, label: str, mistake: Mistake) -> Any:
    """Return what comes of a case for the solution with one mistake."""
    return observed(cases.cases[label], cases.mistaken(mistake))


def observed(case: Case, answer: Any) -> Any:
    """Return what comes of a case; of an answer that raises, or leads to something odd, the failure.

    What mistakes print while they are tried is dropped: the learner has not written that.
    """
    out, err = (StringIO(), StringIO()) if watch.explaining else (sys.stdout, sys.stderr)
    try:
        with redirect_stdout(out), redirect_stderr(err):
            return case(answer)
    except Failure as failure:
        return failure
    except Exception as error:  # noqa: BLE001 - whatever an odd answer leads to
        text = f"what it has made cannot be read: {type(error).__name__}: {error}"
        return Failure(name_of(answer), error if isinstance(error, Misuse) else Misuse(text, UNLIKE))


def call(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call what the learner wrote.

    Raises:
        Failure: it raised.
    """
    with watch.call(name_of(function)):
        return function(*arguments)


def ask(function: Any, *given: Any, read: Callable[[Any], Any], wanted: str) -> Any:
    """Call a function of the learner's, and read what it returns.

    Args:
        function: the learner's.
        given: its arguments, which it has to leave as they are.
        read: makes an observation of what was returned.
        wanted: what is to be returned, as a sentence.

    Raises:
        Failure: it raised, has returned something that cannot be read, or has changed what it was given.
    """
    before = [*map(str, given)]
    with watch.call(name_of(function)):
        returned = function(*given)
        changed = [type(each).__name__ for each, said in zip(given, before) if str(each) != said]
        if changed:
            raise Misuse(f"the {changed[0]} that was given is not the same afterwards", CHANGED)
        if isinstance(returned, Iterator):
            wanted = f"With yield, or in parentheses, something makes an iterator. {wanted}"
        else:
            with suppress(AttributeError, TypeError, ValueError):
                return read(returned)
        if returned is None:
            raise Misuse("it returns None", f"Most likely return is missing. {wanted}")
        raise Misuse(f"it returns a {type(returned).__name__}", wanted)


def same(a: Any, b: Any) -> bool:
    """Whether two observations are the same, but for what floats lose, and where a failure was."""
    if isinstance(a, Failure) and isinstance(b, Failure):
        return a.kind == b.kind
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(map(same, a, b))
    if isinstance(a, Real) and isinstance(b, Real):
        return isclose(a, b, rel_tol=TOLERANCE, abs_tol=TOLERANCE) or (isnan(a) and isnan(b))
    return bool(a == b)
