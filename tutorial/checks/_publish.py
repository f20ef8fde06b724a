"""Looking at an answer to `publish`: when it sends, and what, beside what the joints really did."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import degrees
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.body import Body
from tutorial.checks._node import WatchedPublisher
from tutorial.checks._rate import Rate, judge_source, judge_stamps
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint, endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Failure
from tutorial.checks._world import Moment, World
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError

__all__ = ["MADE", "judge_publish"]

NAMES = ("TURRET_Y", "TURRET_P")
UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}

NO_NAMES = "Most likely message.name is left out: without names nobody knows whose positions they are."
OTHER_NAMES = "Take the names from the joints, in their order: [joint.name for joint in self.joints]."
PREFIXED = "Most likely the body's name is put before the joint's: the topic says already whose joints they are."
REORDERED = "Most likely the names are sorted or turned round: keep the order of io.body.joints."
MISSING = "Most likely the loop ends too early, or begins too late: every joint of io.body.joints is named."
ADDED = "Most likely the lists grow from message to message: begin each message with new ones."
EXCHANGED = "Most likely the names are in one order and the numbers in another: run over the same joints for all."
DEGREES = "Most likely they are converted to degrees: ROS 2 uses rad."
STALE = "Most likely the numbers are read once and kept: read every joint at the time of sending."
BEHIND = "Most likely these are the numbers of the message before: read every joint at the time of sending."
DISPLAYED = (
    "Most likely the joints are those of config.body, the displayed copy: what is simulated is io.body, its joints."
)
ROUNDED = "Most likely the numbers are rounded: send them as they are."
NEGATED = "Most likely the sign is turned round: send the numbers as they are."
ONCE = (
    "Most likely the message is filled once, in initialize, and sent again and again: fill it in control, every time."
)
SHORT = "Most likely {field} is left out or cut: it has one number for each name."
OTHER_FIELD = "Most likely {field} is filled with {other}: [joint.{field} for joint in self.joints]."
ZEROS = "Most likely {field} is filled with zeros: [joint.{field} for joint in self.joints]."
MIXED = "Most likely {field} is filled with something else: [joint.{field} for joint in self.joints]."
TYPED = (
    "Most likely the joints' names are typed, or how many there are: take all of them from the body, io.body.joints."
)
SHARED = "Most likely what is kept belongs to the class, and so to all bodies: make it in configure or initialize."
RESTART = (
    "Most likely what says when to publish is kept from the run before: initialize is called at every start, and has "
    "to begin anew, at step 0."
)
RATE = Rate(
    hz=25,
    several="Most likely there is a message for each joint: one names all joints, with one list for each field.",
    others={50: "Most likely that is the rate of JointStatePublisher; here it is 25 Hz."},
)
MADE = "config.node.create_publisher(JointState, topic, 1)"


class _Mover(SimpleController):
    """Turns every joint, each differently, so that no two numbers are alike."""

    def initialize(self, io: ControllerIO) -> None:
        self._joints = io.body.joints

    def control(self) -> None:
        for i, joint in enumerate(self._joints):
            joint.effort = 3.0 + 2.0 * i


def judge_publish(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look at an answer to `publish`."""
    shared = SharedState(answer)
    with World(answer, name="Rover", before=[_Mover()]) as world:
        world.displayed.set_joint_positions({name: 0.3 + 0.1 * i for i, name in enumerate(NAMES)})
        publisher = yield from endpoint_on(world.ros.node, WatchedPublisher, "/Rover/turret", JointState, MADE)
        if publisher is None:
            return
        world.advance(1200)
        odd = judge_source(answer, world)
        if odd is not None:
            yield odd
            return
        rate = RATE.judge(publisher, 0.001)
        findings = [rate, *(_judge_messages(publisher.sent, NAMES, world.displayed) if publisher.sent else ())]
        yield from findings
        if publisher.sent:
            other = World(answer, name="Rover", time_step=0.002)
            yield from RATE.judge_step(other, "/Rover/turret", JointState, publisher, rate)
        if all(finding.right for finding in findings):
            yield from _judge_crane(answer, world, publisher, shared)
            yield _judge_restart(world, publisher)
        yield judge_leaving(answer, world.leave, publisher)


def _judge_crane(
    answer: type[SimpleController], world: World, publisher: WatchedPublisher, shared: SharedState
) -> Iterator[Finding]:
    """Look whether it works on a body with other joints, beside the first one."""
    when = "on the crane Lift"
    try:
        with World(answer, model="crane", name="Lift", time_step=0.002) as lift:
            names = lift.body.joint_names
            before = len(publisher.sent)
            for each, steps in ((lift, 100), (world, 100), (lift, 100)):
                each.advance(steps)
            second = endpoint(lift.ros.node, WatchedPublisher, "/Lift/turret", JointState)
            if second is None or not second.sent:
                yield wrong(f"{when}, nothing is published on /Lift/turret", shared.cause(TYPED))
                return
            findings = list(_judge_messages(second.sent, names, lift.displayed))
            both = [*publisher.sent[before:]]
    except Failure as failure:
        typed = isinstance(failure.error, (TutorialError, LookupError, ValueError))
        yield failure.finding(shared.cause(TYPED) if typed else None, when)
        return
    if not all(finding.right for finding in findings):
        yield from (wrong(f"{when}, {each.text}", shared.cause(TYPED)) for each in findings if not each.right)
    elif not both or not all(finding.right for finding in _judge_messages(both, NAMES, world.displayed)):
        yield wrong(
            "two bodies at the same time: the first one's messages are not its own any more", shared.cause(SHARED)
        )
    else:
        yield right(f"it works {when}, too, with the joints {', '.join(names)}")


def _judge_restart(world: World, publisher: WatchedPublisher) -> Finding:
    """Look whether it begins anew when the simulation does."""
    publisher.sent.clear()
    world.restart()
    world.advance(200)
    when = "after a restart of the simulation"
    if len(publisher.sent) < 2:
        return wrong(f"{when}, {('no message', '1 message')[len(publisher.sent)]} in 0.2 s", RESTART)
    wrongs = [RATE.judge(publisher, 0.001), *_judge_messages(publisher.sent, NAMES, world.displayed)]
    for finding in wrongs:
        if not finding.right:
            return wrong(f"{when}, {finding.text}", RESTART)
    return right(f"{when} it begins anew")


def _judge_messages(sent: Sequence[tuple[Any, Moment]], wanted: Sequence[str], displayed: Body) -> Iterator[Finding]:
    contents = [(m.header.stamp, list(m.name), list(m.position), list(m.velocity), list(m.effort)) for m, _ in sent]
    if len(contents) > 1 and contents[0][2] and all(content == contents[0] for content in contents):
        yield wrong("every message is the same as the first", ONCE)
        return
    yield judge_stamps(sent)
    odd = next((m.name for m, _ in sent if tuple(m.name) != tuple(wanted)), wanted)
    names = tuple(odd)
    finding = _judge_names(names, tuple(wanted))
    yield finding
    if finding.right or sorted(names) == sorted(wanted):
        for field in UNITS:
            yield _judge_field(field, names, sent, displayed)


def _judge_names(names: tuple[str, ...], wanted: tuple[str, ...]) -> Finding:
    if names == wanted:
        return right(f"the names are {' and '.join(names)}")
    if not names:
        return wrong("the messages have no names", NO_NAMES)
    text = f"the names are {', '.join(names)}, not {', '.join(wanted)}"
    if tuple(name.rpartition("/")[2] for name in names) == wanted:
        return wrong(text, PREFIXED)
    if sorted(names) == sorted(wanted):
        return wrong(text, REORDERED)
    if len(names) > len(wanted) and set(names) <= set(wanted):
        return wrong(text, ADDED)
    return wrong(text, MISSING if set(names) < set(wanted) else OTHER_NAMES)


def _judge_field(field: str, names: tuple[str, ...], sent: Sequence[tuple[Any, Moment]], displayed: Body) -> Finding:
    """Compare one of the arrays with what the joints really did."""
    for message, _ in sent:
        count = len(getattr(message, field))
        if count != len(names):
            text = f"{field} has {count} number{'s' * (count != 1)} for {len(names)} names"
            return wrong(text, SHORT.format(field=field))
    truths = [[moment.joints[name][field] for name in names] for _, moment in sent]
    given = [list(getattr(message, field)) for message, _ in sent]
    if all(map(_near, given, truths)):
        return right(f"{field} is each joint's, in {UNITS[field]}")
    return wrong(f"{field} is not what the joints do", _why_these(field, names, sent, displayed))


def _why_these(field: str, names: tuple[str, ...], sent: Sequence[tuple[Any, Moment]], displayed: Body) -> str:
    """Name the likeliest cause of numbers that are not what the joints do, by those of the last message."""
    message, moment = sent[-1]
    given = list(getattr(message, field))
    truth = [moment.joints[name][field] for name in names]
    others = [other for other in UNITS if other != field]
    shown = [getattr(displayed.joint(name), field) for name in names]
    guesses = (
        (shown if any(shown) else (), DISPLAYED),
        ([0.0] * len(names) if field != "position" else (), ZEROS.format(field=field)),
        (truth[::-1], EXCHANGED),
        ([degrees(value) for value in truth], DEGREES),
        ([sent[0][1].joints[name][field] for name in names], STALE),
        ([sent[max(len(sent) - 2, 0)][1].joints[name][field] for name in names], BEHIND),
        ([-value for value in truth], NEGATED),
        *(([moment.joints[name][o] for name in names], OTHER_FIELD.format(field=field, other=o)) for o in others),
        *(([round(value, digits) for value in truth], ROUNDED) for digits in range(6)),
    )
    return next((cause for numbers, cause in guesses if _near(given, numbers)), MIXED.format(field=field))


def _near(a: Sequence[float], b: Sequence[float]) -> bool:
    return len(a) == len(b) and all(abs(x - y) <= 1e-9 + 1e-6 * abs(y) for x, y in zip(a, b))
