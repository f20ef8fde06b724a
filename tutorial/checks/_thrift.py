"""Looking at an answer to `thrift`: which joints it sends when their motion is known."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from math import degrees
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._node import WatchedPublisher
from tutorial.checks._publish import MADE
from tutorial.checks._rate import judge_source, judge_stamps
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint, endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import Failure
from tutorial.checks._world import World
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError

__all__ = ["judge_thrift"]

JOINTS = ("BRIDGE", "SLEW", "LUFF")
PERIOD = 20  # steps between two messages at most

SEGMENTS = {
    "the first message": (1, (0.0, 0.0, 0.0)),
    "nothing moves": (4, (0.0, 0.0, 0.0)),
    "SLEW moves": (1, (0.0, 0.05, 0.0)),
    "SLEW rests again": (2, (0.0, 0.0, 0.0)),
    "SLEW and LUFF creep, each by little": (1, (0.0, 0.0006, 0.0006)),
    "LUFF creeps": (8, (0.0, 0.0, 0.0004)),
    "BRIDGE and SLEW move": (1, (0.02, 0.05, 0.0)),
    "LUFF creeps on while SLEW moves": (9, (0.0, 0.05, 0.0004)),
    "BRIDGE moves back": (1, (-0.02, 0.0, 0.0)),
    "all rests": (3, (0.0, 0.0, 0.0)),
}
"""For how many periods, and by how much the joints move at the beginning of each."""
FAST = 4  # periods in the end, in which SLEW moves at every step
JUMPS = {4: 7, 7: 13, 10: 3}
"""After all that: in which periods SLEW moves, and at which step within each, between two looks."""
LENGTHS = [*(count for count, _ in SEGMENTS.values()), FAST]  # of each segment, in periods

REPLACED = "self.sent = ... forgets the other joints: self.sent.update(news) keeps what was sent for them."
MISTAKES = (
    Mistake("period", 1, "control looks at every step: look 50 times per second, every 20 steps of 1 ms."),
    Mistake("period", 40, "control looks 25 times per second: here it is 50 times."),
    Mistake("period", 50, "the rate, 50 in a second, is taken for the number of steps: with 1 ms it is 20 steps."),
    Mistake("period", 10, "control looks 100 times per second: here it is 50 times."),
    Mistake("period", 19, "the count is off by one: from one look to the next there are 20 steps of 1 ms."),
    Mistake("period", 21, "the count is off by one: from one look to the next there are 20 steps of 1 ms."),
    Mistake(
        "first", False, "the first message is forgotten: nothing was sent yet, so self.sent is empty, and all are news."
    ),
    Mistake("send", "always", "every joint is sent every time: name only those that have moved."),
    Mistake("send", "whole", "the whole message is sent as soon as one joint moves: name only those that did."),
    Mistake("send", "first", "only the first joint that has moved is named, as with break: name all that have."),
    Mistake("send", "first later", "only the first joint that has moved is named, as with break: name all that have."),
    Mistake(
        "send", "last", "only the last joint that has moved is named: name all that have, each added to the lists."
    ),
    Mistake("send", "empty", "a message is sent even if no joint has moved: then send none."),
    Mistake("send", "names", "all names are in the message, but only some positions: they go in pairs."),
    Mistake(
        "compare",
        "last",
        "positions are compared with those of the last look: a slow motion is then never sent. Compare "
        "with what was last sent.",
    ),
    Mistake(
        "compare", "all", "all positions are remembered as soon as one joint is sent: remember only those that were."
    ),
    Mistake(
        "compare",
        "never",
        "what was sent is never different: it is renewed before it is compared, or it is one and the same list or dict "
        "as the current positions. Compare first, send, and then note down a copy.",
    ),
    Mistake("compare", "total", "the changes of all joints are added up: compare each joint for itself with 0.001."),
    Mistake("compare", "rounded", "rounded positions are compared: how far they are apart counts, abs(a - b) > 0.001."),
    Mistake(
        "compare", "cut off", "truncated positions are compared: how far they are apart counts, abs(a - b) > 0.001."
    ),
    Mistake("compare", "negative", "the sign gets in the way: compare abs(...) with 0.001."),
    Mistake("compare", "squared", "squares are compared: abs(a - b) is what counts, against 0.001."),
    Mistake("compare", "once", "what was sent is not remembered: note it down whenever you send."),
    Mistake("compare", "replaced", REPLACED),
    Mistake("compare", "emptied", REPLACED),
    Mistake("compare", "signed", "the sign gets in the way: compare abs(...) with 0.001."),
    Mistake("threshold", 0.0, "any change counts: only more than 0.001 does."),
    *(
        Mistake("threshold", each, f"the threshold is {each}: it is 0.001.")
        for each in (0.01, 0.002, 0.0005, 0.0001, 0.1)
    ),
)
OTHERWISE = "Compare each joint's position with the one that was last sent for it, every 20 steps."
NOT_PAIRS = "Most likely names and positions come from two different lists: take both from the joints that have moved."
DIFFERENCE = "Most likely it is how far the joint has moved: send where it is, joint.position."
OLD = "Most likely it is the position that was sent before: send the new one, and note that down."
DEGREES = "Most likely it is converted to degrees: ROS 2 uses rad."
ROUNDED = "Most likely it is rounded: send it as it is."
DISPLAYED = "Most likely it is that of config.body, the displayed copy: what is simulated is io.body, its joints."
NOT_A_NAME = "Take the name from the joint, joint.name: nothing is put before it or changed."
TWICE = "Most likely the lists grow from message to message: begin each message with new ones."
FILLED = "Most likely the message is filled as in JointStatePublisher: here it has names and positions only."
NOTHING = "Most likely control never comes to publish: in the beginning nothing was sent, so all joints are news."
SINCE_SENT = (
    "Most likely the steps are counted from the last message: after a pause it looks at every step then. Count them "
    "from the last look, io.step % steps_per_look."
)
FIXED_STEPS = "Most likely the number of steps is written down for 1 ms: compute it from io.time_step."
TYPED = "Most likely the joints' names are typed, or how many there are: take them from io.body.joints."
SHARED = "Most likely what was sent belongs to the class, and so to all bodies: make it in initialize, self.sent = {}."
RESTART = "Most likely what says when to look is kept from the run before: initialize begins anew, at step 0."


class _Mover(SimpleController):
    """Puts joints where they are to be, at every step, and leaves them there in the end.

    Args:
        names: of the joints.
        poses: where they are at each step [rad or m].
    """

    def __init__(self, names: Sequence[str], poses: Sequence[Sequence[float]]) -> None:
        self._names, self._poses = names, poses

    def initialize(self, io: ControllerIO) -> None:
        self._io = io
        self._joints = [io.body.joint(name) for name in self._names]

    def control(self) -> None:
        self._io.body.data.qvel[:] = 0.0
        for joint, position in zip(self._joints, self._poses[min(self._io.step, len(self._poses) - 1)]):
            joint.position = position


def judge_thrift(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `thrift`."""
    shared = SharedState(answer)
    with World(answer, model="crane", name="Lift", before=[_Mover(JOINTS, [*_poses(), *_jumps()])]) as world:
        world.displayed.set_joint_positions({name: 0.3 + 0.1 * i for i, name in enumerate(JOINTS)})
        publisher = yield from endpoint_on(world.ros.node, WatchedPublisher, "/Lift/joint_state", JointState, MADE)
        if publisher is None:
            return
        world.advance(sum(LENGTHS) * PERIOD)
        odd = judge_source(answer, world)
        if odd is not None or not publisher.sent:
            yield odd or wrong("nothing is sent", NOTHING)
            return
        seen = _by_segment([(m.step, tuple(message.name), len(message.position)) for message, m in publisher.sent])
        probes = [Probe(label, numbers, _say, _want) for label, numbers in zip((*SEGMENTS, "SLEW moves fast"), seen)]
        looks = judge_probes(probes, predict, MISTAKES, shared.cause(OTHERWISE))
        all_right = yield from judged(chain(looks, _judge_contents(publisher, world)))
        if all_right:
            yield from _judge_beside(answer, world, publisher, shared)
        yield judge_leaving(answer, world.leave, publisher)


def _judge_contents(publisher: WatchedPublisher, world: World) -> Iterator[Finding]:
    yield _judge_pairs(publisher, world)
    yield _judge_rest(publisher)
    yield judge_stamps(publisher.sent)


def _judge_pairs(publisher: WatchedPublisher, world: World) -> Finding:
    """Look whether each position is that of the joint named with it."""
    last: dict[str, float] = {}
    wrongs = []
    for message, moment in publisher.sent:
        if len(set(message.name)) < len(message.name):
            return wrong(f"one message names {', '.join(message.name)}", TWICE)
        truth = {name: fields["position"] for name, fields in moment.joints.items()}
        for name, position in zip(message.name, message.position):
            if name not in truth:
                return wrong(f"the body has no joint {name!r}", NOT_A_NAME)
            if abs(truth[name] - position) > 1e-9:
                shown = world.displayed.joint(name).position
                wrongs.append(_WrongPosition(name, position, truth, last.get(name, 0.0), shown))
            last[name] = truth[name]
    if not wrongs:
        return right("each position is that of the joint named with it")
    known = [cause for cause, explains in _POSITIONS.items() if all(map(explains, wrongs))]
    first = wrongs[0]
    text = f"the position sent for {first.name} is {first.position:g}, not {first.truth[first.name]:g}"
    return wrong(text, known[0] if known else NOT_PAIRS)


@dataclass(frozen=True)
class _WrongPosition:
    """A position that is not the joint's.

    Attributes:
        name, position: as they were sent.
        truth: where the joints were, by name.
        before: where the joint was when it was sent before.
        shown: where the displayed joint is.
    """

    name: str
    position: float
    truth: dict[str, float]
    before: float
    shown: float

    def is_any(self, *numbers: float) -> bool:
        """Whether it is one of these numbers."""
        return any(abs(number - self.position) < 1e-9 for number in numbers)

    @property
    def moved(self) -> float:
        """How far the joint has moved."""
        return self.truth[self.name] - self.before


_POSITIONS: dict[str, Callable[[_WrongPosition], bool]] = {
    DISPLAYED: lambda each: each.is_any(each.shown),
    NOT_PAIRS: lambda each: each.is_any(*(q for name, q in each.truth.items() if name != each.name)),
    DIFFERENCE: lambda each: each.is_any(each.moved, -each.moved, abs(each.moved)),
    OLD: lambda each: each.is_any(each.before),
    DEGREES: lambda each: each.is_any(degrees(each.truth[each.name])),
    ROUNDED: lambda each: each.is_any(*(round(each.truth[each.name], digits) for digits in range(6))),
}


def _judge_beside(
    answer: type[SimpleController], world: World, publisher: WatchedPublisher, shared: SharedState
) -> Iterator[Finding]:
    """Look at a second body beside the first one, with other joints and another time step; then at a new start."""
    before = len(publisher.sent)
    begin = world.simulation.step
    world.advance(9 * PERIOD)
    when = "on the tank Rover, with steps of 2 ms"
    poses = list(_second())
    try:
        with World(answer, name="Rover", time_step=0.002, before=[_Mover(SECOND, poses)]) as rover:
            rover.advance(len(poses))
            second = endpoint(rover.ros.node, WatchedPublisher, "/Rover/joint_state", JointState)
            sent = second.sent if second is not None else []
            world.advance(4 * PERIOD)
    except Failure as failure:
        typed = isinstance(failure.error, (TutorialError, LookupError, ValueError))
        yield failure.finding(shared.cause(TYPED) if typed else None, when)
        return
    wanted = _messages(poses, 10)
    if [tuple(message.name) for message, _ in sent] != [tuple(SECOND[i] for i in named) for _, named, _ in wanted]:
        fewer = 0 < len(sent) < len(wanted)
        cause = shared.cause(FIXED_STEPS if fewer else TYPED)
        yield wrong(f"{when}: {len(sent)} message{'s' * (len(sent) != 1)}; expected: {len(wanted)}", cause)
        return
    yield right(f"it works {when}, too")
    yield _judge_jumps(publisher, before, begin, shared)
    yield _judge_restart(world, publisher)


def _judge_jumps(publisher: WatchedPublisher, before: int, begin: int, shared: SharedState) -> Finding:
    """Look whether it looks in time with its first look when a joint moves between two of them."""
    first = publisher.sent[0][1].step
    sent = [each for each in publisher.sent[before:] if each[1].step >= begin + 2 * PERIOD]  # SLEW has come to rest
    steps = [moment.step for _, moment in sent]
    when = "SLEW moves between two looks"
    if any(1 < (step - first) % PERIOD < PERIOD - 1 for step in steps):
        return wrong(f"{when}: it looks in between, too", SINCE_SENT)
    due = [begin + period * PERIOD + at for period, at in JUMPS.items()]
    in_time = len(steps) == len(due) and all(0 <= step - jump <= PERIOD for step, jump in zip(steps, due))
    if not in_time or any(tuple(message.name) != ("SLEW",) for message, _ in sent):
        return wrong(f"{when}, while the tank publishes, too: it is not sent", shared.cause(SHARED))
    return right(f"{when}: it is sent at the next one")


def _judge_restart(world: World, publisher: WatchedPublisher) -> Finding:
    """Look whether it begins anew when the simulation does."""
    publisher.sent.clear()
    world.restart()
    world.advance(8 * PERIOD)
    if not any("SLEW" in message.name for message, _ in publisher.sent):
        return wrong("after a restart of the simulation nothing is sent", RESTART)
    return right("after a restart of the simulation it begins anew")


def _judge_rest(publisher: WatchedPublisher) -> Finding:
    for field in ("velocity", "effort"):
        if any(len(getattr(message, field)) for message, _ in publisher.sent):
            return wrong(f"{field} is not empty", FILLED)
    return right("velocity and effort stay empty")


def _poses() -> Iterator[tuple[float, ...]]:
    """Yield where the joints are at each step [m, rad, rad]."""
    pose: tuple[float, ...] = (0.0, 0.0, 0.0)  # where they are before the first step, too
    for count, move in SEGMENTS.values():
        for _ in range(count):
            pose = tuple(a + b for a, b in zip(pose, move))
            yield from [pose] * PERIOD
    for _ in range(FAST * PERIOD):
        pose = (pose[0], pose[1] + 0.0011, pose[2])
        yield pose


def _jumps() -> Iterator[tuple[float, ...]]:
    """Yield where the joints are at each step [m, rad, rad] when SLEW moves between two looks."""
    *_, pose = _poses()
    for period in range(max(JUMPS) + 3):
        for step in range(PERIOD):
            pose = (pose[0], pose[1] + 0.05 * (JUMPS.get(period) == step), pose[2])
            yield pose


SECOND = ("TURRET_Y", "TURRET_P")


def _second() -> Iterator[tuple[float, ...]]:
    """Yield where the second body's joints are at each step [rad]: 10 steps of 2 ms from look to look."""
    pose = (0.0, 0.0)
    for move in (
        (0.0, 0.0),
        (0.0, 0.0),
        (0.0, 0.05),
        (0.0, 0.0),
        (0.0004, 0.0),
        (0.0004, 0.0),
        (0.0004, 0.0),
        (0.0, 0.0),
    ):
        pose = (pose[0] + move[0], pose[1] + move[1])
        yield from [pose] * 10
    for _ in range(60):
        pose = (pose[0], pose[1] + 0.0011)
        yield pose


def predict(**parts: Any) -> Sequence[tuple[float, ...]]:
    """Compute which messages are sent in each segment, right or with some mistakes."""
    poses = list(_poses())
    messages = _messages(poses, **{"period": PERIOD, **parts})
    return _by_segment([(step, tuple(JOINTS[i] for i in named), count) for step, named, count in messages])


def _messages(
    poses: Sequence[tuple[float, ...]],
    period: int,
    first: bool = True,
    send: str = "moved",
    compare: str = "sent",
    threshold: float = 0.001,
) -> list[tuple[int, list[int], int]]:
    """Compute what is sent: at which step, which joints are named, and how many positions there are."""
    messages = []
    known: list[float | None] = [None if first else position for position in poses[0]]
    for step in range(0, len(poses), period):
        pose = poses[step]
        everything = list(range(len(pose)))
        moved = [i for i in everything if _moved(pose[i], known[i], compare, threshold)]
        if compare == "total" and None not in known:
            total = sum(abs(a - b) for a, b in zip(pose, known) if b is not None)
            moved = everything if total > threshold else []
        named = _named(moved, everything, send, None in known)
        if named or send == "empty":
            messages.append((step, named, len(moved if send == "names" else named)))
        if compare == "emptied" or (compare == "replaced" and named):
            known = [None] * len(pose)
        for i in everything:
            if _remembered(compare, i in (moved if send == "names" else named), bool(named), known[i] is None):
                known[i] = pose[i]
    return messages


def _named(moved: list[int], everything: list[int], send: str, is_first: bool) -> list[int]:
    """Return the joints that are named when some have moved."""
    if send == "always" or (moved and send in ("whole", "names")):
        return everything
    if send == "first" or (send == "first later" and not is_first):
        return moved[:1]
    return moved[-1:] if send == "last" else moved


def _moved(position: float, known: float | None, compare: str, threshold: float) -> bool:
    if known is None:
        return True
    difference = position - known
    measured = {"signed": difference, "negative": -difference, "squared": difference**2}
    known_otherwise = {
        "never": False,
        "rounded": round(position, 3) != round(known, 3),
        "cut off": int(position * 1000) != int(known * 1000),
    }
    return known_otherwise.get(compare, measured.get(compare, abs(difference)) > threshold)


def _remembered(compare: str, sent: bool, any_sent: bool, nothing_yet: bool) -> bool:
    if compare == "once":
        return nothing_yet
    return {"last": True, "all": any_sent}.get(compare, sent)


def _by_segment(messages: Sequence[tuple[int, tuple[str, ...], int]]) -> list[tuple[float, ...]]:
    """Sort messages into segments; each is three numbers: its period within the segment, its joints, its positions."""
    found: list[tuple[float, ...]] = []
    begin = 0
    for count in LENGTHS:
        inside = [m for m in messages if begin <= m[0] // PERIOD < begin + count]
        numbers = [(step // PERIOD - begin, _code(names), positions) for step, names, positions in inside]
        found.append(tuple(chain.from_iterable(numbers)))
        begin += count
    return found


def _code(names: tuple[str, ...]) -> int:
    """Write down as one number which joints are named."""
    return sum(1 << JOINTS.index(name) for name in set(names) & set(JOINTS))


def _want(numbers: tuple[float, ...]) -> str:
    return _say(numbers) if numbers else "no message"


def _say(numbers: tuple[float, ...]) -> str:
    if not numbers:
        return "nothing is sent"
    messages = list(zip(numbers[0::3], numbers[1::3], numbers[2::3]))
    count = f"{len(messages)} message{'s' * (len(messages) != 1)}"
    kinds = {(names, positions) for _, names, positions in messages}
    if len(kinds) > 1:
        return f"{count} of {len(kinds)} kinds"
    names = [joint for i, joint in enumerate(JOINTS) if int(messages[0][1]) >> i & 1]
    positions = int(messages[0][2])
    short = "" if positions == len(names) else f" and {positions} position{'s' * (positions != 1)}"
    return f"{count} with {' and '.join(names) or 'nothing'}{short}"
