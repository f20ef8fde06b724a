"""Diagnose: find out why an answer is wrong, by comparing it with the solution and its twins, the copies with mistakes.

The diagnosis is the smallest set of mistakes that makes the solution behave like the answer in every case.
"""

import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from itertools import chain, combinations

from tutorial.checks.engine.cases import Fault
from tutorial.checks.engine.observe import Observation, Observations, same
from tutorial.checks.engine.slips import another, missing
from tutorial.checks.engine.twins import Twins
from tutorial.errors import TutorialError

LONGEST = 20.0  # [s] time limit for trying mistakes, so that the check ends even on a busy machine
CRASHES = (LookupError, ValueError, ArithmeticError, TypeError, TutorialError, UnboundLocalError)


class Why(Enum):
    """Why an observation is wrong, if no known mistake explains it."""

    CLOCK = auto()  # the answer reads the computer's clock
    MEANING = auto()  # see `Case.meaning`
    CRASH = auto()  # the answer raised an exception that the case's meaning explains; the check stops here
    EXCEPTION = auto()  # the answer raised an exception that only its own message explains; the check stops here


@dataclass(frozen=True)
class Diagnosis:
    """Why an answer is wrong.

    Attributes:
        causes: the mistake or other cause that each case reveals, by the case's label. If a case without
            an entry is odd, these causes also explain that case.
    """

    causes: Mapping[str, Fault | Why]


# Mistakes that explain an answer, and the observations that these mistakes do not explain.
_Explanation = tuple[Sequence[Fault], Sequence[Observation]]


def diagnose(seen: Observations, twins: Twins) -> Diagnosis:
    """Find the causes of an answer's odd observations.

    Args:
        seen: all observations of the answer.
        twins: tries the solution with mistakes.
    """
    odd = seen.odd
    if not odd:
        return Diagnosis({})
    if twins.cases.clock and any("clock" in each.noted for each in odd):
        return Diagnosis({odd[0].case.label: Why.CLOCK})
    found, aside = _explanation(seen, twins)
    causes: dict[str, Fault | Why] = {**_shown(found, [each for each in odd if each not in aside], twins)}
    for each in aside:
        if not any(twins.shows(each.case, fault) for fault in found):
            causes[each.case.label] = _own_cause(each, twins)
    if not found and odd[0] not in aside:
        causes[odd[0].case.label] = Why.MEANING
    return Diagnosis(causes)


def _own_cause(odd: Observation, twins: Twins) -> Why:
    """Return the cause of a wrong observation that no mistake explains."""
    if not odd.failed:
        return Why.MEANING
    is_crash = isinstance(odd.value.error, CRASHES) or "NoneType" in str(odd.value.error)
    has_meaning = twins.cases.meaning_of(odd.case) != twins.cases.meaning
    return Why.CRASH if is_crash and odd.case.crashes and has_meaning else Why.EXCEPTION


def _explanation(seen: Observations, twins: Twins) -> _Explanation:
    """Explain all observations or, failing that, all but the exceptions, or all but odd cases that share a meaning."""
    failed = [each for each in seen.all if each.failed]
    misused = [each for each in failed if each.is_misuse]
    alike = _with_the_same_meaning(seen, twins)
    for aside in _each_once([], misused, failed, *alike):
        rest = [each for each in seen.all if each not in aside]
        found = explain(rest, twins, most=1 if aside in alike else 2)
        if found:
            return found, aside
    return (), failed


def _with_the_same_meaning(seen: Observations, twins: Twins) -> list[list[Observation]]:
    """Return the odd observations whose cases define a meaning, grouped by meaning."""
    groups = dict[str, list[Observation]]()
    for each in seen.odd:
        groups.setdefault(twins.cases.meaning_of(each.case), []).append(each)
    groups.pop(twins.cases.meaning, None)
    return [*groups.values()]


def _each_once(*groups: list[Observation]) -> list[list[Observation]]:
    return [group for i, group in enumerate(groups) if group not in groups[:i]]


def _shown(found: Sequence[Fault], odd: Sequence[Observation], twins: Twins) -> dict[str, Fault]:
    """Assign each mistake to the first unassigned case that it breaks on its own; return the mistakes by case label."""
    shown, free = dict[str, Fault](), [*odd]
    for fault in found:
        first = next((each for each in free if twins.shows(each.case, fault)), next(iter(free), None))
        if first is not None:
            shown[first.case.label] = fault
            free.remove(first)
    return shown


def explain(seen: Sequence[Observation], twins: Twins, most: int = 2) -> tuple[Fault, ...]:
    """Return the one or two mistakes that together produce exactly these observations; () if there are none.

    Args:
        seen: the observations.
        twins: tries the solution with mistakes.
        most: the maximum number of mistakes to combine.
    """
    odd = [each for each in seen if each.is_odd]
    if not odd:
        return ()
    search = _Search(seen, odd, twins)
    pairs = search.pairs() if most == 2 else ()
    deadline = time.monotonic() + LONGEST
    for faults in chain(search.single(), search.wrong_parts(), pairs):
        if time.monotonic() > deadline:
            break
        if search.leads_to_all(faults):
            return faults
    return ()


class _Search:
    """The candidates for an explanation, in the order of the search.

    The search first tries each candidate in the last odd case, which usually reveals the most. It skips slips if only
    one case is odd or an exception was raised, because too many slips would fit.
    """

    def __init__(self, seen: Sequence[Observation], odd: Sequence[Observation], twins: Twins) -> None:
        self._seen, self._twins, self._last = seen, twins, odd[-1]
        self._has_slips = len(odd) > 1 and not any(each.failed for each in seen)
        self._known = [*twins.cases.faults, *(twins.slips(missing) if self._has_slips else ())]
        self._leading = [each for each in self._known if same(twins.does(self._last.case, each), self._last.value)]
        # Odd cases come first: a wrong candidate most likely differs in them. Each group begins with its fastest case.
        self._quickest = sorted(seen, key=lambda each: (not each.is_odd, each.seconds))

    def single(self) -> Iterator[tuple[Fault, ...]]:
        """Yield each mistake that alone leads to the last odd observation."""
        return ((each,) for each in self._leading)

    def wrong_parts(self) -> Iterator[tuple[Fault, ...]]:
        """Yield each slip within a statement."""
        return ((each,) for each in self._twins.slips(another)) if self._has_slips else iter(())

    def pairs(self) -> Iterable[tuple[Fault, ...]]:
        """Yield the pairs in which one mistake alone explains the last odd case, or each breaks that case on its own.

        Yield no pairs for an answer that failed in the first case or ran in fewer than half of the cases: a pair would
        only be a guess.
        """
        cases = self._twins.cases
        if self._seen[0].failed or cases.one_by_one or 2 * len(self._seen) < len(cases.cases):
            return
        showing = {each for each in self._known if self._twins.shows(self._last.case, each)}
        leading = {*self._leading}
        for two in combinations(self._known, 2):
            if showing.issuperset(two) or not leading.isdisjoint(two):
                yield two

    def leads_to_all(self, faults: tuple[Fault, ...]) -> bool:
        """Return whether the solution with these mistakes behaves like the answer in every case."""
        return all(same(self._twins.does(each.case, *faults), each.value) for each in self._quickest)
