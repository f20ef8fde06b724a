"""Looking at an answer to `by_name`: messages as they come, and as they should not."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isnan, nan
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Failure, watch

__all__ = ["judge_match"]

BODY = ("TURRET_Y", "TURRET_P", "HATCH")

NOT_A_DICT = "Return a dict from names to positions, an empty one when there is nothing to tell."
WRONG_ORDER = (
    "Most likely positions are matched by their place: the i-th position belongs to the i-th name of the message."
)
NO_SUBSET = "Most likely every joint is expected in every message: go through the message's names, not the body's."
INVENTED = "Most likely a joint without a position is set to 0: leave it out, then it stays where it is."
UNKNOWN = "Most likely names that the body does not have are kept: leave them out, if name in joint_names."
UNKNOWN_CRASH = "Most likely a name is looked up that the body does not have: ask first, if name in joint_names."
SHORT_CRASH = "Most likely there is an index beyond the end: zip(message.name, message.position) ends with the shorter."
SHORT_DROPPED = "Most likely a message with fewer positions is dropped as a whole: use those that are there."
EMPTY = "Most likely an empty position array is not expected: it says nothing about the pose, so return {}."
NAN = "Most likely NaN is passed on: leave out what is not a number, math.isnan tells."
NAN_DROPPED = "Most likely one NaN makes the whole message invalid: leave out only that joint."
FIRST_WINS = "Most likely the first of two of the same name wins: the last one does, as in dict(pairs)."
CHANGED = "Most likely pop, sort or remove is used on the message's own lists: leave the message as it is."


@dataclass(frozen=True)
class _Case:
    """One message.

    Attributes:
        label: what it is like.
        names, positions: what it says.
        wanted: the right answer.
        cause: the most likely cause of a wrong answer, unless zeros were invented.
        crash: the most likely cause when something is raised.
        symptom: names a cause that comes before these, if what was returned is a symptom of it; else nothing.
    """

    label: str
    names: Sequence[str]
    positions: Sequence[float]
    wanted: Mapping[str, float]
    cause: str
    crash: str
    symptom: Callable[[dict[str, float]], str] = lambda _given: ""

    def guess(self, given: dict[str, float]) -> str:
        """Name the most likely cause of what was returned."""
        return self.symptom(given) or (INVENTED if 0.0 in given.values() else self.cause)


def _by_place(given: dict[str, float]) -> str:
    return WRONG_ORDER if "TURRET_Y" in given and 0.0 not in given.values() else ""


def _with_nan(given: dict[str, float]) -> str:
    return NAN if any(map(isnan, given.values())) else ""


TWINS = ("TURRET_Y", "TURRET_P", "TURRET_Y")
IN_ORDER = dict(zip(BODY, (0.1, 0.2, 0.3)))
CASES = (
    _Case("all joints, in order", BODY, (0.1, 0.2, 0.3), IN_ORDER, WRONG_ORDER, NO_SUBSET),
    _Case("another order", BODY[::-1], (0.3, 0.2, 0.1), IN_ORDER, WRONG_ORDER, WRONG_ORDER),
    _Case("only HATCH", ("HATCH",), (0.3,), {"HATCH": 0.3}, NO_SUBSET, NO_SUBSET, _by_place),
    _Case("an unknown name, ANTENNA", ("ANTENNA", "TURRET_P"), (0.9, 0.2), {"TURRET_P": 0.2}, UNKNOWN, UNKNOWN_CRASH),
    _Case("3 names, 2 positions", BODY, (0.1, 0.2), {"TURRET_Y": 0.1, "TURRET_P": 0.2}, SHORT_DROPPED, SHORT_CRASH),
    _Case("no positions", BODY, (), {}, EMPTY, EMPTY),
    _Case("NaN for TURRET_P", BODY, (0.1, nan, 0.3), {"TURRET_Y": 0.1, "HATCH": 0.3}, NAN_DROPPED, NAN, _with_nan),
    _Case("TURRET_Y twice", TWINS, (0.1, 0.2, 0.3), {"TURRET_Y": 0.3, "TURRET_P": 0.2}, FIRST_WINS, FIRST_WINS),
)


def judge_match(answer: Callable[[Sequence[str], JointState], Any]) -> Iterator[Finding]:
    """Look at an answer to `by_name`."""
    changed = False
    for case in CASES:
        message = JointState(name=list(case.names), position=list(case.positions))
        try:
            with watch.call(answer.__name__):
                given = answer(BODY, message)
        except Failure as failure:
            known = isinstance(failure.error, (LookupError, ValueError))
            yield failure.finding(case.crash if known else None, case.label)
            continue
        changed = changed or list(message.name) != list(case.names) or len(message.position) != len(case.positions)
        if not isinstance(given, dict):
            yield wrong(f"{case.label}: {answer.__name__} returns {_called(given)}", NOT_A_DICT)
            return
        yield _compare(case, given)
    if changed:
        yield wrong("the message is not the same afterwards", CHANGED)


def _compare(case: _Case, given: dict[str, Any]) -> Finding:
    same = given.keys() == case.wanted.keys() and all(_near(given[name], q) for name, q in case.wanted.items())
    if same:
        return right(f"{case.label}: {_say(given)}")
    numbers = all(isinstance(value, (int, float)) for value in given.values())
    cause = case.guess(given) if numbers else NOT_A_DICT
    return wrong(f"{case.label}: {_say(given)}; expected: {_say(case.wanted)}", cause)


def _near(value: Any, wanted: float) -> bool:
    return isinstance(value, (int, float)) and abs(value - wanted) < 1e-9


def _say(positions: Mapping[str, Any]) -> str:
    said = {name: f"{q:g}" if isinstance(q, float) else repr(q) for name, q in sorted(positions.items())}
    return "{" + ", ".join(f"{name}: {q}" for name, q in said.items()) + "}"


def _called(value: Any) -> str:
    return "None" if value is None else f"a {type(value).__name__}"
