"""Looking at an answer to `thrift`: which joints it sends when their motion is known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from sensor_msgs.msg import JointState

from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._node import WatchedPublisher
from tutorial.checks._publish import MADE, judge_stamps
from tutorial.checks._topics import endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._world import World
from tutorial.controller import ControllerIO, SimpleController

__all__ = ["judge_thrift"]

JOINTS = ("BRIDGE", "SLEW", "LUFF")
PERIOD = 20  # steps between two messages at most

SEGMENTS = {
    "the first message": (1, (0.0, 0.0, 0.0)),
    "nothing moves": (4, (0.0, 0.0, 0.0)),
    "SLEW moves": (1, (0.0, 0.05, 0.0)),
    "SLEW rests again": (2, (0.0, 0.0, 0.0)),
    "LUFF creeps": (8, (0.0, 0.0, 0.0004)),
    "BRIDGE and SLEW move": (1, (0.02, 0.05, 0.0)),
    "LUFF creeps on while SLEW moves": (9, (0.0, 0.05, 0.0004)),
    "BRIDGE moves back": (1, (-0.02, 0.0, 0.0)),
    "all rests": (3, (0.0, 0.0, 0.0)),
}
"""For how many periods, and by how much the joints move at the beginning of each."""
FAST = 4  # periods in the end, in which SLEW moves at every step
LENGTHS = [*(count for count, _ in SEGMENTS.values()), FAST]  # of each segment, in periods

REPLACED = "self.sent = ... forgets the other joints: self.sent.update(news) keeps what was sent for them."
MISTAKES = (
    Mistake("period", 1, "control looks at every step: look 50 times per second, every 20 steps of 1 ms."),
    Mistake("period", 40, "control looks 25 times per second: here it is 50 times."),
    Mistake(
        "first", False, "the first message is forgotten: nothing was sent yet, so self.sent is empty, and all are news."
    ),
    Mistake("send", "always", "every joint is sent every time: name only those that have moved."),
    Mistake("send", "whole", "the whole message is sent as soon as one joint moves: name only those that did."),
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
    Mistake("compare", "once", "what was sent is not remembered: note it down whenever you send."),
    Mistake("compare", "replaced", REPLACED),
    Mistake("compare", "emptied", REPLACED),
    Mistake("compare", "signed", "the sign gets in the way: compare abs(...) with 0.001."),
    Mistake("threshold", 0.0, "any change counts: only more than 0.001 does."),
    Mistake("threshold", 0.01, "the threshold is another: it is 0.001."),
)
OTHERWISE = "Compare each joint's position with the one that was last sent for it, every 20 steps."
NOT_PAIRS = "Most likely names and positions come from two different lists: take both from the joints that have moved."
FILLED = "Most likely the message is filled as in JointStatePublisher: here it has names and positions only."
NOTHING = "Most likely control never comes to publish: in the beginning nothing was sent, so all joints are news."


class _Mover(SimpleController):
    """Puts the joints where the segments say, at every step."""

    def initialize(self, io: ControllerIO) -> None:
        self._io = io
        self._joints = [io.body.joint(name) for name in JOINTS]
        self._poses = list(_poses())

    def control(self) -> None:
        self._io.body.data.qvel[:] = 0.0
        for joint, position in zip(self._joints, self._poses[self._io.step]):
            joint.position = position


def judge_thrift(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `thrift`."""
    with World(answer, model="crane", name="Lift", before=[_Mover()]) as world:
        publisher = yield from endpoint_on(world.ros.node, WatchedPublisher, "/Lift/joint_state", JointState, MADE)
        if publisher is None:
            return
        world.advance(sum(LENGTHS) * PERIOD)
        if not publisher.sent:
            yield wrong("nothing is sent", NOTHING)
            return
        seen = _by_segment([(m.step, tuple(message.name), len(message.position)) for message, m in publisher.sent])
        probes = [Probe(label, numbers, _say, _want) for label, numbers in zip((*SEGMENTS, "SLEW moves fast"), seen)]
        yield from judge_probes(probes, predict, MISTAKES, OTHERWISE)
        yield _judge_pairs(publisher)
        yield _judge_rest(publisher)
        yield judge_stamps(publisher.sent)
        yield judge_leaving(answer, world.leave, publisher)


def _judge_pairs(publisher: WatchedPublisher) -> Finding:
    for message, moment in publisher.sent:
        for name, position in zip(message.name, message.position):
            if name not in moment.joints or abs(moment.joints[name]["position"] - position) > 1e-9:
                return wrong(f"the position sent for {name} is another joint's, or an old one", NOT_PAIRS)
    return right("each position is that of the joint named with it")


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
    for _ in range(FAST * PERIOD + 1):
        pose = (pose[0], pose[1] + 0.0011, pose[2])
        yield pose


def predict(
    period: int = PERIOD,
    first: bool = True,
    send: str = "moved",
    compare: str = "sent",
    threshold: float = 0.001,
) -> Sequence[tuple[float, ...]]:
    """Compute which messages are sent in each segment, right or with some mistakes."""
    messages = []
    poses = list(_poses())
    known: list[float | None] = [None if first else position for position in poses[0]]
    for step in range(0, sum(LENGTHS) * PERIOD, period):
        pose = poses[step]
        moved = [i for i in range(3) if _moved(pose[i], known[i], compare, threshold)]
        named = moved if send in ("moved", "empty") or not (moved or send == "always") else [0, 1, 2]
        if named or send == "empty":
            messages.append((step, tuple(JOINTS[i] for i in named), len(moved if send == "names" else named)))
        if compare == "emptied" or (compare == "replaced" and named):
            known = [None, None, None]
        for i in range(3):
            if _remembered(compare, i in (moved if send == "names" else named), bool(named), known[i] is None):
                known[i] = pose[i]
    return _by_segment(messages)


def _moved(position: float, known: float | None, compare: str, threshold: float) -> bool:
    if known is None:
        return True
    difference = position - known
    return (difference if compare == "signed" else abs(difference)) > threshold


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
