"""Looking at an answer to `gaps`: bags as they are recorded, and what is wrong in them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import isclose
from typing import Any

from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks._answer import name_of
from tutorial.checks._diagnose import Misuse
from tutorial.checks._explain import Mistake
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Failure, watch

__all__ = ["judge_gaps"]

SECOND = 1_000_000_000  # [ns]
PERIOD = 20_000_000  # [ns] from one message to the next, as the bag received them
SINCE_1970 = 1_750_000_000  # [s]
MOST_SAID = 4  # of what was found, in one line

Found = list[tuple[Any, ...]]  # what happened, and the stamps [ns]

LIKELY = "Most likely "
STAMPS = "Most likely something else than the stamps is compared: stamp.sec and stamp.nanosec, both, in whole numbers."
EXACT = "Most likely seconds are computed as floating point numbers, which are rounded: count in whole nanoseconds."
LIMIT = "Most likely the limit is another: more than 0.1 s, which is 100_000_000 ns, is a gap."
NEWEST = "Most likely each stamp is compared with the last one: compare it with the newest one so far."
LATE = "Most likely a message that is a little late is not expected: up to 1 s back, it says nothing."
EQUAL = "Most likely equal stamps are not expected: the second of them says nothing."
BACK = "Most likely the limit of a restart is another: more than 1 s back, which is 1_000_000_000 ns."
RESET = "Most likely the newest stamp does not begin anew after a restart: then it is that of the new message."
FIRST = "Most likely the first message is compared with something: there is none before it."
EMPTY = "Most likely a bag without a message is not expected: return an empty list."
INDEX = "Most likely there is an index beyond the end: keep what came before in a variable, then no index is needed."
COMPARE = "Compare with: newest is the newest stamp since the last restart, and each stamp is compared with it."
NO_RETURN = "Most likely return is missing: give the list back, an empty one when there is nothing to tell."
YIELDS = "A list was asked for: with yield a function makes a generator. Append to a list, and return it."
NOT_A_LIST = 'Return a list of tuples such as ("gap", 1_200_000_000, 1_500_000_000), an empty one for nothing.'
WORDS = 'The words are "gap" and "restart".'
CHANGED = "Most likely sort, pop, remove or an assignment changes the list or a message: leave them as they are."
KEPT = "Most likely the list is kept from call to call: make a new one in every call, and not as a default argument."


@dataclass(frozen=True)
class _Case:
    """One bag.

    Attributes:
        label: what it is like.
        stamps: of its messages [s].
        otherwise: the most likely cause when it is wrong and nothing known explains it.
        plus: nanoseconds that are added to the last stamp.
        pause: how long the bag received nothing before its last message [s].
        since: what is added to all stamps [s].
    """

    label: str
    stamps: Sequence[float]
    otherwise: str
    plus: int = 0
    pause: float = 0.0
    since: int = 0

    def stamps_ns(self) -> list[int]:
        """The stamps [ns]."""
        whole = [round(stamp * SECOND) + self.since * SECOND for stamp in self.stamps]
        return [*whole[:-1], *(last + self.plus for last in whole[-1:])]

    def received_ns(self) -> list[int]:
        """When the bag received them [ns]."""
        times = [SINCE_1970 * SECOND + i * PERIOD for i in range(len(self.stamps))]
        return [*times[:-1], *(last + round(self.pause * SECOND) for last in times[-1:])]

    def messages(self) -> list[tuple[int, JointState]]:
        """Make the pairs."""
        pairs = []
        for received, stamp in zip(self.received_ns(), self.stamps_ns()):
            message = JointState(name=["TURRET_Y"], position=[0.1])
            message.header.stamp = Time(nanoseconds=stamp).to_msg()
            pairs.append((received, message))
        return pairs


STANDS = "each stamp is compared with the first one, or the last where something was found: newest has to move on."

CASES = (
    _Case("20 ms apart", (1.0, 1.02, 1.04, 1.06), COMPARE),
    _Case("0.3 s without a message", (1.0, 1.02, 1.32, 1.34), STAMPS),
    _Case("the bag waits 3 s, the stamps do not", (1.0, 1.02, 1.04), STAMPS, pause=3.0),
    _Case("a gap across a full second", (2.9, 2.95, 3.08, 3.1), STAMPS),
    _Case("a full second, and no gap", (2.96, 2.98, 3.0, 3.02), STAMPS),
    _Case("started again", (3.96, 3.98, 0.0, 0.02), BACK),
    _Case("late, and no gap", (1.0, 1.08, 1.02, 1.14, 1.16), NEWEST),
    _Case("late after a gap", (1.0, 1.5, 1.1, 1.52), NEWEST),
    _Case("late before a gap", (1.0, 1.02, 1.01, 1.14), NEWEST),
    _Case("half a second late", (1.0, 1.02, 0.52, 1.04), LATE),
    _Case("equal stamps", (1.0, 1.0, 1.02, 1.02), EQUAL),
    _Case("exactly 0.1 s apart", (0.1, 0.2, 0.3, 0.4), EXACT),
    _Case("0.1 s and 1 ns apart", (1.0, 1.1), LIMIT, plus=1),
    _Case("exactly 1 s back", (2.0, 1.0, 2.02), BACK),
    _Case("1 s and 1 ns back", (2.0, 1.0), BACK, plus=-1),
    _Case("begins at 5 s", (5.0, 5.02), FIRST),
    _Case("a gap after 0 s", (0.0, 0.5, 0.52), FIRST),
    _Case("started again, then a gap", (3.98, 0.0, 0.02, 0.42, 0.44), RESET),
    _Case("started again twice", (3.98, 0.0, 2.0, 2.02, 0.5, 0.52), RESET),
    _Case("started again, not from 0", (100.0, 100.02, 50.0, 50.02), RESET),
    _Case("two gaps alike", (1.0, 1.2, 1.4), COMPARE),
    _Case("half a minute without a message", (1.0, 1.02, 31.02, 31.04), LIMIT),
    _Case("a robot's stamps, exactly 0.1 s apart", (0.1, 0.2, 0.3, 0.4), EXACT, since=SINCE_1970),
    _Case("a robot's stamps, 0.1 s and 1 ns apart", (0.1, 0.2), EXACT, plus=1, since=SINCE_1970),
    _Case("no message", (), EMPTY),
    _Case("a single message", (1.0,), EMPTY),
)

MISTAKES = (
    Mistake("stamp", "received", "the bag's times are compared: they say when a message was received, not made."),
    Mistake("stamp", "sec", "nanosec is left out: a stamp is sec and nanosec together."),
    Mistake("stamp", "nanosec", "sec is left out: nanosec begins anew with every second."),
    Mistake("stamp", "sec in ns", "nanosec is left out: a stamp is sec and nanosec together."),
    Mistake("stamp", "float", EXACT.removeprefix(LIKELY)),
    Mistake("stamp", "float in ns", EXACT.removeprefix(LIKELY)),
    Mistake("stamp", "milliseconds", "stamps are cut to milliseconds: count in whole nanoseconds."),
    Mistake("unit", "s", "the stamps are told in seconds: they are asked for in nanoseconds."),
    Mistake("unit", "ms", "the stamps are told in milliseconds: they are asked for in nanoseconds."),
    Mistake("told", "exchanged", "the two stamps are exchanged: the one before comes first, then the one after."),
    Mistake("told", "received", "the bag's times are told: the stamps are asked for."),
    Mistake("told", "before", "the stamp after is missing: what happened, the stamp before, the stamp after."),
    Mistake("told", "length", "its length is told in place of the stamp after it."),
    Mistake("told", "last", "the last message's stamp is told: a late one is not where the gap begins."),
    Mistake("told", "index", "the messages' numbers are told: their stamps are asked for."),
    Mistake("compared", "last", NEWEST.removeprefix(LIKELY)),
    Mistake("compared", "first", STANDS),
    Mistake("compared", "where something was found", STANDS),
    Mistake("compared", "sorted", "the messages are sorted first: then no restart is seen. Take them as they come."),
    Mistake("first", "zero", "newest begins with 0, so the first message counts as a gap: there is none before it."),
    Mistake("first", "falsy", "a stamp of 0 is taken for none, as in `if newest`: ask whether it `is None`."),
    Mistake("gap", "not before", "0.1 s counts as a gap: more than 0.1 s does."),
    Mistake("gap", "a second", "the limit of a gap is 1 s: it is 0.1 s, which is 100_000_000 ns."),
    Mistake("gap", "10 ms", "the limit of a gap is ten times too small: 0.1 s is 100_000_000 ns."),
    Mistake("gap", "1 s at most", "a gap of over 1 s does not count: however long, it is one."),
    Mistake("gap", "none", "no gap is told: a stamp more than 0.1 s after the newest one is one."),
    Mistake("gap", "both ways", "a restart is told as a gap: abs() takes a step back for one ahead."),
    Mistake("back", "any", "any step back counts as a restart: up to 1 s back, a message is late."),
    Mistake("back", "any or none", "equal stamps count as a restart: only more than 1 s back is one."),
    Mistake("back", "0.1 s", "the limit of a restart is 0.1 s: it is 1 s."),
    Mistake("back", "not before", "1 s back counts as a restart: more than 1 s does."),
    Mistake("back", "never", "no restart is told: a stamp more than 1 s back is one."),
    Mistake("late", "told", "a late message is told: it says nothing."),
    Mistake("after", "kept", RESET.removeprefix(LIKELY)),
    Mistake("after", "none", "after a restart nothing is looked at any more: go on."),
    Mistake("after", "zero", "after a restart newest becomes 0: it is the stamp of the new message."),
    Mistake("given", "first", "it ends with the first that is found: return after the loop."),
    Mistake("given", "last", "only the last that is found is told: append each of them."),
    Mistake("given", "reversed", "the newest is told first: keep the bag's order."),
    Mistake("given", "by kind", "gaps and restarts are told apart: keep the bag's order."),
    Mistake("seen", "not the last", "the loop ends before the last message: zip, or enumerate, needs no - 1."),
)


@dataclass(frozen=True)
class _Model:
    """An answer that is right but for its mistakes; without arguments it is the right one."""

    stamp: str = "whole"
    unit: str = "ns"
    told: str = "stamps"
    compared: str = "newest"
    first: str = "none"
    gap: str = "more than 0.1 s"
    back: str = "more than 1 s"
    late: str = "nothing"
    after: str = "anew"
    given: str = "all"
    seen: str = "all"

    def answer(self, case: _Case) -> Found:
        """Return what it makes of a bag."""
        found: Found = []
        pairs = list(zip(case.received_ns(), case.stamps_ns()))
        if self.compared == "sorted":
            pairs.sort(key=lambda pair: pair[1])
        if self.seen == "not the last":
            pairs = pairs[:-1]
        newest: float | None = 0 if self.first == "zero" else None
        place = 0  # of the newest
        for i, pair in enumerate(pairs):
            stamp = self._stamp(*pair)
            if newest is None or (self.first == "falsy" and newest == 0):
                newest, place = stamp, i
                continue
            ahead = stamp - newest
            what = self._what(ahead)
            if what:
                found.append((what, *self._told(newest, stamp, pairs, place, i)))
            if what == "restart" and self.after == "none":
                break
            newest, place = self._next(what, newest, stamp, place, i)
        return self._given(found)

    def _stamp(self, received: int, stamp: int) -> float:
        """Return what is compared."""
        sec, nanosec = divmod(stamp, SECOND)
        kinds = {
            "received": received,
            "sec": sec,
            "sec in ns": sec * SECOND,
            "nanosec": nanosec,
            "float": sec + nanosec / SECOND,
            "float in ns": sec + nanosec / SECOND,
            "milliseconds": stamp // 1_000_000 * 1_000_000,
        }
        return kinds.get(self.stamp, stamp)

    def _what(self, ahead: float) -> str:
        """Return what a step of the stamps means."""
        in_seconds = self.stamp in ("sec", "float", "float in ns")
        second, tenth = (1.0, 0.1) if in_seconds else (SECOND, SECOND // 10)
        restarts = {
            "any": ahead < 0,
            "any or none": ahead <= 0,
            "0.1 s": ahead < -tenth,
            "not before": ahead <= -second,
            "never": False,
        }
        gaps = {
            "not before": ahead >= tenth,
            "a second": ahead > second,
            "10 ms": ahead > tenth / 10,
            "1 s at most": tenth < ahead <= second,
            "none": False,
            "both ways": abs(ahead) > tenth,
        }
        if self.gap == "both ways" and gaps[self.gap]:
            return "gap"
        if restarts.get(self.back, ahead < -second):
            return "restart"
        if gaps.get(self.gap, ahead > tenth):
            return "gap"
        return "late" if self.late == "told" and ahead < 0 else ""

    def _told(
        self, before: float, after: float, pairs: Sequence[tuple[int, int]], place: int, i: int
    ) -> tuple[float, ...]:
        unit = {"s": 1e9, "ms": 1e6}.get(self.unit, 1) if self.stamp != "float in ns" else 1e-9
        told = {
            "exchanged": (after, before),
            "received": (pairs[place][0], pairs[i][0]),
            "before": (before,),
            "length": (before, after - before),
            "last": (pairs[i - 1][1], after),
            "index": (place, i),
        }
        numbers = told.get(self.told, (before, after))
        return tuple(each / unit for each in numbers) if unit != 1 else numbers

    def _next(self, what: str, newest: float, stamp: float, place: int, i: int) -> tuple[float, int]:
        """Return what the next stamp is compared with, and its place."""
        if what == "restart" and self.after != "anew":
            return (0, i) if self.after == "zero" else (newest, place)
        stands = {"first": what != "restart", "where something was found": not what}
        if stands.get(self.compared, False):
            return newest, place
        is_new = stamp > newest or what == "restart" or self.compared == "last"
        return (stamp, i) if is_new else (newest, place)

    def _given(self, found: Found) -> Found:
        if self.given == "by kind":
            return sorted(found, key=lambda each: each[0])
        kinds = {"first": found[:1], "last": found[-1:], "reversed": found[::-1]}
        return kinds.get(self.given, found)


def judge_gaps(answer: Callable[[list[tuple[int, JointState]]], Any]) -> Iterator[Finding]:
    """Look at an answer to `gaps`."""
    shared = SharedState(answer)
    seen: list[Found | Failure] = []
    lists: list[Any] = []
    for case in CASES:
        messages = case.messages()
        copy = list(messages)
        try:
            with watch.call(name_of(answer)):
                given = answer(messages)
        except Failure as failure:
            if isinstance(failure.error, Misuse):
                yield failure.finding()
                return
            seen.append(failure)
            continue
        odd = _judge_kind(answer, case, given) or _judge_untouched(case, messages, copy)
        if odd is None and isinstance(given, list) and any(given is each for each in lists):
            odd = wrong(f"{case.label}: the same list is returned as the time before", KEPT)
        if odd is not None:
            yield from _judge_found(seen, shared)
            yield odd
            return
        lists.append(given)
        seen.append([tuple(each) for each in given])
    yield from _judge_found(seen, shared)


def _judge_kind(answer: Any, case: _Case, given: Any) -> Finding | None:
    """Look whether something else is returned than a list of what happened."""
    text = f"{case.label}: {name_of(answer)} returns {'None' if given is None else f'a {type(given).__name__}'}"
    if not isinstance(given, (list, tuple)):
        return wrong(text, NO_RETURN if given is None else YIELDS if isinstance(given, Iterator) else NOT_A_LIST)
    for each in given:
        if not isinstance(each, (list, tuple)) or not each or not isinstance(each[0], str):
            return wrong(f"{case.label}: in the list is {_cut(each)}", NOT_A_LIST)
        if not all(isinstance(number, (int, float)) for number in each[1:]):
            return wrong(f"{case.label}: in the list is {_cut(each)}", NOT_A_LIST)
        if each[0] not in ("gap", "restart", "late"):
            return wrong(f"{case.label}: in the list is {_cut(each)}", WORDS)
    return None


def _judge_untouched(case: _Case, messages: list[Any], before: list[Any]) -> Finding | None:
    """Look whether what was given is as it was."""
    same = len(messages) == len(before) and all(a is b for a, b in zip(messages, before))
    stamps = [Time.from_msg(message.header.stamp).nanoseconds for _, message in before]
    if same and stamps == case.stamps_ns():
        return None
    return wrong(f"{case.label}: the messages are not the same afterwards", CHANGED)


def _judge_found(seen: Sequence[Found | Failure], shared: SharedState) -> Iterator[Finding]:
    """Compare what was returned with what should have been, and name the mistakes where they show first."""
    found = _explained(seen)
    told: list[str] = []
    crashes: dict[object, str] = {}  # by place, the cause that was named first
    for case, given in zip(CASES, seen):
        if isinstance(given, Failure):
            known = isinstance(given.error, (LookupError, ValueError))
            cause = crashes.setdefault(given.place, EMPTY if len(case.stamps) < 2 else INDEX)
            yield given.finding(cause if known else None, case.label)
            continue
        wanted = _Model().answer(case)
        if given == wanted:
            yield right(f"{case.label}: {_say(given)}")
            continue
        causes = [f"{LIKELY}{each.cause}" for each in found if _by(each).answer(case) != wanted]
        cause = next((each for each in causes if each not in told), "")
        if cause or not causes:
            told.append(cause)
            text = f"{case.label}: {_say(given)}; expected: {_say(wanted)}"
            yield wrong(text, cause or shared.cause(case.otherwise))


def _explained(seen: Sequence[Found | Failure]) -> tuple[Mistake, ...]:
    """Find the fewest mistakes that lead to exactly what was returned; none when nothing that is known does."""
    answers = [(case, given) for case, given in zip(CASES, seen) if not isinstance(given, Failure)]
    for count in range(3):
        for chosen in combinations(MISTAKES, count):
            parts = {each.part: each.value for each in chosen}
            if len(parts) == count:
                model = replace(_Model(), **parts)
                if all(_near(given, model.answer(case)) for case, given in answers):
                    return chosen
    return ()


def _near(given: Found, predicted: Found) -> bool:
    """Whether they are the same, but for the last digits of floating point numbers."""
    pairs = [(a, b) for one, other in zip(given, predicted) for a, b in zip(one[1:], other[1:])]
    kinds, wanted = ([(each[0], len(each)) for each in found] for found in (given, predicted))
    return kinds == wanted and all(a == b or (isinstance(b, float) and isclose(a, b)) for a, b in pairs)


def _by(mistake: Mistake) -> _Model:
    return replace(_Model(), **{mistake.part: mistake.value})


def _say(found: Found) -> str:
    if not found:
        return "nothing"
    said = [f"{what} {' '.join(f'{number:_}' for number in numbers)}" for what, *numbers in found[:MOST_SAID]]
    return ", ".join(said) + (f" and {len(found) - MOST_SAID} more" if len(found) > MOST_SAID else "")


def _cut(each: Any) -> str:
    return repr(each)[:60]
