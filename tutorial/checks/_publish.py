"""Looking at an answer to `publish`: when it sends, and what, beside what the joints really did."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import degrees
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.checks._node import WatchedPublisher
from tutorial.checks._topics import endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Failure
from tutorial.checks._world import Moment, World
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError

__all__ = ["MADE", "judge_publish", "judge_stamps"]

RATE = 25  # [Hz]
NAMES = ("TURRET_Y", "TURRET_P")
UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}

NOTHING = "Most likely control never comes to publish: look at the condition, io.step % steps_per_message == 0."
TIMER = (
    "Most likely a timer publishes: it goes by the wall clock, on the executor's thread. Count steps in control: "
    "simulated time is io.step * io.time_step."
)
EVERY_STEP = "Most likely control publishes at every step: do so only when io.step % steps_per_message == 0."
OLD_RATE = "Most likely that is the rate of JointStatePublisher; here it is 25 Hz."
PERIOD = "Most likely the period is another: it is round(1 / (25 * io.time_step)) steps."
FIXED_STEPS = "Most likely the number of steps is written down for 1 ms: compute it from io.time_step."
NO_STAMP = "Most likely the stamp is left out: message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()."
WALL_CLOCK = "Most likely that is the wall clock's time: take the simulation's, self.io.time_ns."
OTHER_STAMP = "Compare with message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg(), at the time of sending."
NO_NAMES = "Most likely message.name is left out: without names nobody knows whose positions they are."
OTHER_NAMES = "Take the names from the joints, in their order: [joint.name for joint in self.joints]."
PREFIXED = "Most likely the body's name is put before the joint's: the topic says already whose joints they are."
REORDERED = "Most likely the names are sorted or turned round: keep the order of io.body.joints."
EXCHANGED = "Most likely the names are in one order and the numbers in another: run over the same joints for all."
DEGREES = "Most likely they are converted to degrees: ROS 2 uses rad."
STALE = "Most likely the numbers are read once and kept: read every joint at the time of sending."
SHORT = "Most likely {field} is left out or cut: it has one number for each name."
MIXED = "Most likely {field} is filled with something else: [joint.{field} for joint in self.joints]."
TYPED = "Most likely the joints' names are typed: take joints and names from the body, io.body.joints."
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
    with World(answer, name="Rover", before=[_Mover()]) as world:
        publisher = yield from endpoint_on(world.ros.node, WatchedPublisher, "/Rover/turret", JointState, MADE)
        if publisher is None:
            return
        world.advance(400)
        if world.ros.node.timers_made:
            yield wrong("messages come from a timer", TIMER)
            return
        findings = [_judge_rate(publisher, 0.001), *(_judge_messages(publisher.sent, NAMES) if publisher.sent else ())]
        yield from findings
        if publisher.sent:
            yield from _judge_step(answer, publisher, findings[0])
        if all(finding.right for finding in findings):
            yield from _judge_crane(answer)
        yield judge_leaving(answer, world.leave, publisher)


def _judge_rate(publisher: WatchedPublisher, time_step: float) -> Finding:
    if len(publisher.sent) < 2:
        return wrong(f"in 0.4 s, {('no message', '1 message')[len(publisher.sent)]} was sent", NOTHING)
    steps = _steps(publisher)
    periods = [b - a for a, b in pairwise(steps)]
    wanted = round(1 / (RATE * time_step))
    said = f"it publishes {_per_second(publisher, time_step)} times per simulated second"
    if all(abs(period - wanted) <= 1 for period in periods):
        return right(f"{said}, with steps of {time_step * 1000:g} ms")
    causes = {1: EVERY_STEP, wanted // 2: OLD_RATE}
    return wrong(f"{said}, not {RATE}", causes.get(periods[0], PERIOD))


def _judge_step(answer: type[SimpleController], usual: WatchedPublisher, rate: Finding) -> Iterator[Finding]:
    """Look whether the rate is the same with another time step, be it the right one or not."""
    with World(answer, name="Rover", time_step=0.002) as world:
        world.advance(200)
        publisher = world.ros.node.watched(WatchedPublisher)[0]
    finding = _judge_rate(publisher, 0.002)
    if finding.right and rate.right:
        yield finding
    elif rate.right:
        yield wrong(f"with steps of 2 ms, {finding.text}", FIXED_STEPS)
    elif min(len(usual.sent), len(publisher.sent)) > 1 and _steps(usual)[1] - _steps(usual)[0] > 1:
        before, after = _per_second(usual, 0.001), _per_second(publisher, 0.002)
        if abs(after - before) > 0.25 * before:
            yield wrong(f"with steps of 2 ms, it publishes {after} times per simulated second", FIXED_STEPS)


def _steps(publisher: WatchedPublisher) -> list[int]:
    return [moment.step for _, moment in publisher.sent]


def _per_second(publisher: WatchedPublisher, time_step: float) -> int:
    steps = _steps(publisher)
    return round((len(steps) - 1) / ((steps[-1] - steps[0] or 1) * time_step))


def _judge_crane(answer: type[SimpleController]) -> Iterator[Finding]:
    """Look whether it works on a body with other joints."""
    when = "on the crane Lift"
    try:
        with World(answer, model="crane", name="Lift") as world:
            world.advance(100)
            names = world.body.joint_names
            findings = list(_judge_messages(world.ros.node.watched(WatchedPublisher)[0].sent, names))
    except Failure as failure:
        yield failure.finding(TYPED if isinstance(failure.error, TutorialError) else None, when)
        return
    if all(finding.right for finding in findings):
        yield right(f"it works {when}, too, with the joints {', '.join(names)}")
    for finding in findings:
        if not finding.right:
            yield wrong(f"{when}, {finding.text}", TYPED)


def judge_stamps(sent: Sequence[tuple[Any, Moment]]) -> Finding:
    """Look whether the messages' stamps are simulated time."""
    stamps = [m.header.stamp.sec * 1_000_000_000 + m.header.stamp.nanosec for m, _ in sent]
    if all(stamp == moment.time_ns for stamp, (_, moment) in zip(stamps, sent)):
        return right("the stamps are simulated time")
    if not any(stamps):
        return wrong("the stamps are 0", NO_STAMP)
    if min(stamps) > 1_000_000 * 1_000_000_000:
        return wrong("the stamps are not simulated time", WALL_CLOCK)
    return wrong("the stamps are not the simulated time of sending", OTHER_STAMP)


def _judge_messages(sent: Sequence[tuple[Any, Moment]], wanted: Sequence[str]) -> Iterator[Finding]:
    yield judge_stamps(sent)
    names = tuple(sent[-1][0].name)
    finding = _judge_names(names, tuple(wanted))
    yield finding
    if finding.right or sorted(names) == sorted(wanted):
        for field in UNITS:
            yield _judge_field(field, names, sent)


def _judge_names(names: tuple[str, ...], wanted: tuple[str, ...]) -> Finding:
    if names == wanted:
        return right(f"the names are {' and '.join(names)}")
    if not names:
        return wrong("the messages have no names", NO_NAMES)
    text = f"the names are {', '.join(names)}, not {', '.join(wanted)}"
    if tuple(name.rpartition("/")[2] for name in names) == wanted:
        return wrong(text, PREFIXED)
    return wrong(text, REORDERED if sorted(names) == sorted(wanted) else OTHER_NAMES)


def _judge_field(field: str, names: tuple[str, ...], sent: Sequence[tuple[Any, Moment]]) -> Finding:
    """Compare one of the arrays with what the joints really did."""
    message, moment = sent[-1]
    given = list(getattr(message, field))
    truth = [moment.joints[name][field] for name in names]
    if len(given) != len(names):
        text = f"{field} has {len(given)} number{'s' * (len(given) != 1)} for {len(names)} names"
        return wrong(text, SHORT.format(field=field))
    if _near(given, truth):
        return right(f"{field} is each joint's, in {UNITS[field]}")
    first = [sent[0][1].joints[name][field] for name in names]
    guesses = ((truth[::-1], EXCHANGED), ([degrees(value) for value in truth], DEGREES), (first, STALE))
    cause = next((cause for numbers, cause in guesses if _near(given, numbers)), MIXED.format(field=field))
    return wrong(f"{field} is not what the joints do", cause)


def _near(a: Sequence[float], b: Sequence[float]) -> bool:
    return len(a) == len(b) and all(abs(x - y) <= 1e-9 + 1e-6 * abs(y) for x, y in zip(a, b))
