"""Report: turn a diagnosis into sentences for the learner."""

from collections.abc import Iterator
from typing import Any

from tutorial.checks.engine.cases import Cases, Fault
from tutorial.checks.engine.diagnose import Diagnosis, Why
from tutorial.checks.engine.exceptions import likely_cause
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.observe import Observation, Observations
from tutorial.checks.engine.shared_state import cause_of_sharing
from tutorial.checks.engine.verdict import Finding, Place, right, wrong


def report(cases: Cases, answer: Any, seen: Observations, diagnosis: Diagnosis) -> Iterator[Finding]:
    """Yield a finding for each case, but skip a wrong result if another finding names its cause.

    Args:
        cases: the cases of the exercise.
        answer: the learner's class or function.
        seen: all observations of the answer.
        diagnosis: why the answer is wrong.
    """
    for each in seen.all:
        label, why = each.case.label, diagnosis.causes.get(each.case.label)
        if not each.is_odd:
            yield right(f"{label}: {cases.describe(each.value)}")
        elif why in (Why.CRASH, Why.EXCEPTION):
            yield finding_of(each.value, answer, cases.meaning_of(each.case) if why is Why.CRASH else None, label)
            return
        elif why is not None:
            place = seen.place_of("clock") if why is Why.CLOCK else None
            yield _wrong(cases, answer, each, _cause(cases, answer, seen, each, why), place)


def finding_of(failure: Failure, answer: Any, cause: str | None = None, label: str = "") -> Finding:
    """Return the finding for a failure, with its most likely cause.

    Args:
        failure: the failure of the learner's code.
        answer: the learner's class or function.
        cause: the most likely cause; None to derive it from the exception.
        label: the label of the case.
    """
    error = failure.error
    first, *_ = [*str(error).strip().splitlines(), ""]
    text = f"{failure.method} raised {type(error).__name__}: {first}".removesuffix(": ")
    if isinstance(error, Misuse):
        text, cause = f"{failure.method}: {error}", cause or error.cause
    if cause is None:
        cause = likely_cause(error, answer)
    return wrong(f"{label}: {text}" if label else text, cause, failure.place)


def _cause(cases: Cases, answer: Any, seen: Observations, odd: Observation, why: Fault | Why) -> str:
    """Return the sentence that explains a cause.

    If the answer's objects share state, the sentence explains this sharing instead. For a known mistake, it does so
    only if the state is stored on a class.
    """
    if isinstance(why, Fault):
        is_shared, sentence = "." in seen.changed, f"Most likely {why.cause}"
    else:
        is_shared = bool(seen.changed)
        sentence = cases.clock if why is Why.CLOCK else cases.meaning_of(odd.case)
    return cause_of_sharing(answer, seen.changed) if is_shared else sentence


def _wrong(cases: Cases, answer: Any, odd: Observation, cause: str, place: Place | None) -> Finding:
    if odd.failed:
        return finding_of(odd.value, answer, cause, odd.case.label)
    text = f"{odd.case.label}: {cases.describe(odd.value)}; expected: {cases.describe(odd.expected)}"
    return wrong(text, cause, place)
