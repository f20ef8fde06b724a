"""Looking at an answer to `pair`: two streams of messages, in step and out of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import inf
from typing import Any

from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState

from tutorial.checks._diagnose import Misuse, sentence
from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure, watch

__all__ = ["judge_pair"]

Arrivals = Sequence[tuple[str, int]]  # the stream, and the stamp [ms]
Pair = tuple[int, int]  # the places of two messages among the arrivals

JOINTS, POSE = "joints", "pose"
MOST = 50  # messages that may wait
NOTHING = -1.0
FACTOR = 1000  # two places in one number

COMPARE = "Compare with: a message waits by its stamp, until the other stream's message of the same stamp is there."
NO_RETURN = "Most likely return is missing: a pair is returned by the call of add that completes it."
NO_PAIR = "Return the two messages, joints, pose, or None as long as one of them is missing."
NOT_THE_MESSAGES = "Return the messages themselves, as they came: joints, pose."
UNHASHABLE = (
    "Most likely the stamp itself is the key of a dict: it may change, so it can't be one. Make a tuple of its two "
    "numbers, stamp.sec and stamp.nanosec."
)
ABSENT = "Most likely a partner is taken for granted: ask first whether it is there."
KEPT = "Most likely what waits belongs to the class, and so to all objects: make it in __init__, self.waiting = {}."
ORDER = "joints come first in a pair, and the pose second, whichever came first."


SECONDS = "sec", "sec in a queue"
NANOSECONDS = "nanosec", "nanosec in a queue"
NEAR = "rounded", "near in a queue"
"""What is compared by mistake. In a dict the last message of a key counts, in a queue the first."""


@dataclass(frozen=True)
class _Case:
    """What arrives, one after the other."""

    label: str
    arrivals: Arrivals


def in_turn(*stamps: int) -> Arrivals:
    """Joints and pose of each of these stamps [ms]."""
    return [(stream, stamp) for stamp in stamps for stream in (JOINTS, POSE)]


def alone(stream: str, count: int, begin: int = 0) -> Arrivals:
    """So many messages of one stream, 20 ms apart."""
    return [(stream, begin + 20 * i) for i in range(count)]


CASES = (
    _Case("in turn", in_turn(20, 40, 60)),
    _Case("the pose first", [(POSE, 20), (JOINTS, 20), (POSE, 40), (JOINTS, 40)]),
    _Case("three joint states, then their poses", [*alone(JOINTS, 3, 20), *alone(POSE, 3, 20)]),
    _Case("three poses, then their joint states", [*alone(POSE, 3, 20), *alone(JOINTS, 3, 20)]),
    _Case("a pose is missing", [*in_turn(20), (JOINTS, 40), *in_turn(60)]),
    _Case("joints are missing", [*in_turn(20), (POSE, 40), (POSE, 60), (JOINTS, 60)]),
    _Case("the same part of another second", [(JOINTS, 1020), (POSE, 2020), (JOINTS, 2020)]),
    _Case("a partner that comes too late", [*in_turn(20), (JOINTS, 40), *in_turn(60), (POSE, 40), *in_turn(80)]),
    _Case("a pose that comes twice", [*in_turn(20), (POSE, 20), *in_turn(40)]),
    _Case("started again, from 0", [*in_turn(5000, 5020), *in_turn(0, 20)]),
    _Case("40 joint states, then their poses", [*alone(JOINTS, 40), *alone(POSE, 40)]),
    _Case("60 joint states, then the poses of the last 40", [*alone(JOINTS, 60), *alone(POSE, 40, 400)]),
    _Case("200 without a partner, then the pose of the first", [*alone(JOINTS, 200), (POSE, 0)]),
    _Case("200 without a partner, then the pose of the last", [*alone(JOINTS, 200), (POSE, 3980)]),
    _Case("200 without a partner, then started again", [*alone(JOINTS, 200, 9000), *in_turn(0, 20)]),
)

MISTAKES = (
    Mistake("order", "none", NO_RETURN.removeprefix("Most likely ")),
    *(Mistake("key", each, "only the seconds are compared: nanosec belongs to the stamp, too.") for each in SECONDS),
    *(Mistake("key", each, "only nanosec is compared: sec belongs to the stamp, too.") for each in NANOSECONDS),
    Mistake("key", "any", "the newest of the other stream is taken, whatever its stamp: only the same stamp will do."),
    Mistake("key", "first", "the first that waits is taken, whatever its stamp: only the same stamp will do."),
    *(Mistake("key", each, "stamps that are almost the same are taken for the same: 20 ms count.") for each in NEAR),
    Mistake("order", "as they came", ORDER),
    Mistake("order", "pose first", ORDER),
    Mistake("when", "pose", "a pair is looked for only when a pose comes: the joints may be the second."),
    Mistake("when", "joints", "a pair is looked for only when joints come: the pose may be the second."),
    Mistake("before", "kept", "what came before a pair still waits: its partner comes too late, so drop it."),
    Mistake("before", "all", "a pair drops all that waits: only what came before it is past."),
    Mistake("taken", "stays", "a pair goes on waiting after it was returned: take it out, pop."),
    Mistake("keep", 1, "only one message of a stream is kept: more may wait, up to 50."),
    Mistake("keep", inf, "there is no limit to what waits: of more than 50, the one that came first gives way."),
    Mistake("keep", "smallest", "the smallest stamp gives way, and after a new start that is the newest message: the "
            "one that came first has to."),
    Mistake("keep", "none", "of more than 50 all are dropped: only the one that came first gives way."),
    Mistake("keep", "full", "what comes when 50 wait is not kept: the one that came first gives way."),
    Mistake("again", "refused", "an older stamp than the last is refused: a publisher that was started again begins "
            "at 0."),
)  # fmt: skip


def judge_pair(answer: type) -> Iterator[Finding]:
    """Look at an answer to `pair`."""
    shared = SharedState(answer)
    if _knows_another(answer):
        yield wrong("what one object was given is there in another one", KEPT)
        return
    probes: list[Probe] = []
    odd = None
    for case in CASES:
        try:
            probes.append(_probe(answer, case))
        except Failure as failure:
            odd = _explained(failure, case.label)
            break
        except _Unlike as unlike:
            odd = wrong(f"{case.label}: {unlike}", unlike.cause)
            break
    all_right = yield from judged(judge_probes(probes, predict, MISTAKES, shared.cause(COMPARE)))
    if odd is not None:
        yield odd
    elif all_right:
        yield right("two objects know nothing of each other")


class _Unlike(Exception):  # noqa: N818 - it is told the learner, and nobody else
    """Something else was returned than a pair or None."""

    def __init__(self, text: str, cause: str) -> None:
        super().__init__(text)
        self.cause = cause


def _probe(answer: type, case: _Case) -> Probe:
    """Have the messages of a case arrive.

    Raises:
        Failure: the answer raised.
        _Unlike: it returned something else than a pair.
    """
    messages = [_message(*arrival) for arrival in case.arrivals]
    with watch.call("__init__"):
        pairs = answer()
    seen = []
    for (stream, _), message in zip(case.arrivals, messages):
        with watch.call("add"):
            returned = pairs.add(stream, message)
        seen.append(_code(returned, messages))
    return Probe(case.label, tuple(seen), lambda codes: _say(codes, case.arrivals))


def _message(stream: str, milliseconds: int) -> Any:
    message = JointState() if stream == JOINTS else TransformStamped()
    message.header.stamp.sec, rest = divmod(milliseconds, 1000)
    message.header.stamp.nanosec = rest * 1_000_000
    return message


def _code(returned: Any, messages: Sequence[Any]) -> float:
    """Which of the messages were returned, as one number."""
    if returned is None:
        return NOTHING
    if not isinstance(returned, (tuple, list)) or len(returned) != 2:
        raise _Unlike(f"add returns a {type(returned).__name__}", NO_PAIR)
    places = [next((i for i, each in enumerate(messages) if each is one), None) for one in returned]
    if places[0] is None or places[1] is None:
        missing = any(one is None for one in returned)
        raise _Unlike("add returns something else than two messages", NO_PAIR if missing else NOT_THE_MESSAGES)
    return float(FACTOR * places[0] + places[1])


def _say(codes: Sequence[float], arrivals: Arrivals) -> str:
    """Name the pairs by their stamps."""
    said = []
    for code in codes:
        if code != NOTHING:
            (one, first), (_, second) = (arrivals[i] for i in divmod(int(code), FACTOR))
            text = f"{first} ms" if first == second else f"{first} with {second} ms"
            said.append(text if one == JOINTS else f"{text}, the pose first")
    count = len(said)
    shown = ", ".join(said) if count <= 3 else f"{said[0]} to {said[-1]}"
    return f"{count} pair{'s' * (count != 1)}, {shown}" if said else "no pair"


def _explained(failure: Failure, label: str) -> Finding:
    text = sentence(failure.error)
    known = isinstance(failure.error, (LookupError, TypeError, StopIteration)) and not isinstance(failure.error, Misuse)
    cause = UNHASHABLE if "unhashable" in text else ABSENT
    return failure.finding(cause if known else None, label)


def _knows_another(answer: type) -> bool:
    """Whether an object makes a pair of what another one was given."""
    with suppress(Failure), watch.call("add"):  # what it raises is told where more is known of it
        one, other = answer(), answer()
        first = one.add(JOINTS, _message(JOINTS, 20))
        return first is None and other.add(POSE, _message(POSE, 20)) is not None
    return False


def predict(
    key: str = "",
    order: str = "",
    when: str = "",
    before: str = "",
    taken: str = "",
    keep: Any = MOST,
    again: str = "",
) -> Iterator[tuple[float, ...]]:
    """Yield what an answer with such mistakes returns for each case; without any, it is the right one."""
    for case in CASES:
        model = _Model(key, order, when, before, taken, keep, again)
        yield tuple(model.add(i, *arrival) for i, arrival in enumerate(case.arrivals))


class _Model:
    """An answer that is right but for its mistakes."""

    def __init__(self, key: str, order: str, when: str, before: str, taken: str, keep: Any, again: str) -> None:
        self.key, self.order, self.when, self.before, self.taken = key, order, when, before, taken
        self.keep, self.again = keep, again
        self.waiting: list[tuple[int, str, int]] = []  # the place, the stream and the stamp, in the order of arrival
        self.newest = -1

    def add(self, place: int, stream: str, stamp: int) -> float:
        """Take a message; return the code of the pair that it completes."""
        if self.again == "refused" and stamp < self.newest:
            return NOTHING
        mine = (place, stream, stamp)
        if self.key not in ("any", "first") and "queue" not in self.key:
            self.waiting = [each for each in self.waiting if not (each[1] == stream and self._same(each, stamp))]
        partner = None if self.when not in ("", stream) else self._partner(stream, stamp)
        if partner is None:
            self._wait(mine)
            return NOTHING
        at = self.waiting.index(partner)
        if self.before == "all":
            self.waiting = []
        elif self.taken == "stays":
            self.waiting = [*self.waiting[at:], mine]
        else:
            earlier = self.waiting[:at] if self.before == "kept" else []
            self.waiting = [*earlier, *self.waiting[at + 1 :]]
            if not self.before:
                self.waiting = [each for each in self.waiting if each[1] != stream]
        self.newest = max(self.newest, stamp)
        pair = (place, partner[0]) if stream == JOINTS else (partner[0], place)
        if self.order == "none":
            return NOTHING
        if self.order == "as they came":
            pair = partner[0], place
        elif self.order == "pose first":
            pair = pair[::-1]
        return float(FACTOR * pair[0] + pair[1])

    def _partner(self, stream: str, stamp: int) -> tuple[int, str, int] | None:
        others = [each for each in self.waiting if each[1] != stream]
        if self.key == "any":
            return others[-1] if others else None
        if self.key == "first":
            return others[0] if others else None
        return next((each for each in others if self._same(each, stamp)), None)

    def _same(self, other: tuple[int, str, int], stamp: int) -> bool:
        (sec, part), (other_sec, other_part) = divmod(stamp, 1000), divmod(other[2], 1000)
        alike = {
            "sec": sec == other_sec,
            "nanosec": part == other_part,
            "rounded": round(stamp, -2) == round(other[2], -2),
            "near": abs(other[2] - stamp) <= 20,
        }
        return alike.get(self.key.partition(" ")[0], stamp == other[2])

    def _wait(self, mine: tuple[int, str, int]) -> None:
        most = self.keep if isinstance(self.keep, (int, float)) else MOST
        own = [each for each in self.waiting if each[1] == mine[1]]
        if self.keep == "full" and len(own) >= most:
            return
        self.waiting.append(mine)
        own.append(mine)
        if len(own) <= most:
            return
        if self.keep == "none":
            self.waiting = []
        else:
            self.waiting.remove(min(own, key=lambda each: each[2]) if self.keep == "smallest" else own[0])
