"""Looking at an answer to `publish`: when it sends, and what, beside what the joints really did."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import degrees
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.body import Body
from tutorial.checks._answer import missing
from tutorial.checks._node import WatchedPublisher
from tutorial.checks._shared import SharedState
from tutorial.checks._topics import endpoint, endpoint_on, judge_leaving
from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import Failure, watch
from tutorial.checks._world import Moment, World
from tutorial.controller import ControllerIO, SimpleController
from tutorial.errors import TutorialError

__all__ = ["MADE", "judge_publish", "judge_source", "judge_stamps"]

RATE = 25  # [Hz]
SECOND = 1_000_000_000  # [ns]
NAMES = ("TURRET_Y", "TURRET_P")
UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}

NOTHING = "Most likely control never comes to publish: look at the condition, io.step % steps_per_message == 0."
TIMER = (
    "Most likely a timer publishes: it goes by the wall clock, on the executor's thread. Count steps in control: "
    "simulated time is io.step * io.time_step."
)
THREAD = (
    "Most likely a thread of its own publishes: it goes by the wall clock, and the simulated body belongs to the "
    "simulation's thread. Publish in control, and count steps."
)
CLOCK = (
    "Most likely the computer's clock says when to publish: simulated time goes faster or slower. Count steps, "
    "io.step % steps_per_message == 0."
)
EVERY_STEP = "Most likely control publishes at every step: do so only when io.step % steps_per_message == 0."
TURNED = "Most likely the condition is turned round: publish when io.step % steps_per_message == 0, and not otherwise."
OLD_RATE = "Most likely that is the rate of JointStatePublisher; here it is 25 Hz."
RATE_FOR_STEPS = (
    "Most likely the rate, 25 in a second, is taken for the number of steps: that is round(1 / (25 * io.time_step)), "
    "or 40 with steps of 1 ms."
)
ONE_OFF = (
    "Most likely the count is off by one: from one message to the next there are round(1 / (25 * io.time_step)) steps."
)
SEVERAL = "Most likely there is a message for each joint: one message names all joints, with one list for each field."
UNEVEN = "Most likely something else than the number of steps says when to publish: io.step % steps_per_message == 0."
PERIOD = "Most likely the period is another: it is round(1 / (25 * io.time_step)) steps."
FIXED_STEPS = "Most likely the number of steps is written down for 1 ms: compute it from io.time_step."
STAMP = "message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()"
NO_STAMP = f"Most likely the stamp is left out: {STAMP}."
WALL_CLOCK = "Most likely that is the wall clock's time: take the simulation's, self.io.time_ns."
ONLY_SECONDS = f"Most likely only whole seconds are set, and nanosec stays 0: {STAMP} sets both."
ONLY_NANOSECONDS = f"Most likely only nanosec is set, and sec stays 0: {STAMP} sets both."
UNIT = f"Most likely the unit is wrong, {{}} for nanoseconds: {STAMP}."
FIXED_STAMP = f"Most likely the stamp is set once and kept: set it in control, for every message. {STAMP}."
OLD_STAMP = f"Most likely the stamp is that of another step: set it in control, right before sending. {STAMP}."
OTHER_STAMP = f"Compare with {STAMP}, at the time of sending."
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
        rate = _judge_rate(publisher, 0.001)
        findings = [rate, *(_judge_messages(publisher.sent, NAMES, world.displayed) if publisher.sent else ())]
        yield from findings
        if publisher.sent:
            yield from _judge_step(answer, publisher, rate)
        if all(finding.right for finding in findings):
            yield from _judge_crane(answer, world, publisher, shared)
            yield _judge_restart(world, publisher)
        yield judge_leaving(answer, world.leave, publisher)


def judge_source(answer: type[SimpleController], world: World) -> Finding | None:
    """Look whether messages come from somewhere else than control; None if not."""
    if world.ros.node.timers_made:
        return wrong("messages come from a timer", TIMER)
    if "thread" in watch.noted:
        return wrong("messages come from a thread of its own", THREAD, watch.noted["thread"])
    return missing(answer, "control")


def _judge_rate(publisher: WatchedPublisher, time_step: float) -> Finding:
    if len(publisher.sent) < 2:
        cause = CLOCK if "clock" in watch.noted else NOTHING
        return wrong(f"in 1.2 s, {('no message', '1 message')[len(publisher.sent)]} was sent", cause)
    steps = _steps(publisher)
    periods = [b - a for a, b in pairwise(steps)]
    wanted = round(1 / (RATE * time_step))
    said = f"it publishes {_per_second(publisher, time_step)} times per simulated second"
    even = all(abs(period - wanted) <= 1 for period in periods)
    if even and abs(steps[-1] - steps[0] - wanted * len(periods)) <= 1:
        return right(f"{said}, with steps of {time_step * 1000:g} ms")
    return wrong(f"{said}, not {RATE}", _why_this_rate(periods, wanted))


def _why_this_rate(periods: Sequence[int], wanted: int) -> str:
    """Name the likeliest cause of the numbers of steps between messages."""
    if "clock" in watch.noted:
        return CLOCK
    if 0 in periods:
        return SEVERAL
    known = {1: EVERY_STEP, wanted // 2: OLD_RATE, RATE: RATE_FOR_STEPS, wanted - 1: ONE_OFF, wanted + 1: ONE_OFF}
    if len(set(periods)) == 1:
        return known.get(periods[0], PERIOD)
    return TURNED if set(periods) == {1, 2} else UNEVEN


def _judge_step(answer: type[SimpleController], usual: WatchedPublisher, rate: Finding) -> Iterator[Finding]:
    """Look whether the rate is the same with another time step, be it the right one or not."""
    with World(answer, name="Rover", time_step=0.002) as world:
        world.advance(600)
        publisher = endpoint(world.ros.node, WatchedPublisher, "/Rover/turret", JointState)
    if publisher is None:
        return
    finding = _judge_rate(publisher, 0.002)
    if finding.right and rate.right:
        yield finding
    elif rate.right:
        yield wrong(f"with steps of 2 ms, {finding.text}", FIXED_STEPS)
    elif min(len(usual.sent), len(publisher.sent)) > 1 and _steps(usual)[1] - _steps(usual)[0] > 1:
        before, after = _per_second(usual, 0.001), _per_second(publisher, 0.002)
        if abs(after - before) > 0.25 * before and rate.cause not in (CLOCK, RATE_FOR_STEPS):
            yield wrong(f"with steps of 2 ms, it publishes {after} times per simulated second", FIXED_STEPS)


def _steps(publisher: WatchedPublisher) -> list[int]:
    return [moment.step for _, moment in publisher.sent]


def _per_second(publisher: WatchedPublisher, time_step: float) -> float:
    """Return how often it publishes in a simulated second, a whole number unless that is 25 and not quite true."""
    steps = _steps(publisher)
    exact = (len(steps) - 1) / ((steps[-1] - steps[0] or 1) * time_step)
    return round(exact) if round(exact) != RATE or abs(exact - RATE) < 0.05 else round(exact, 1)


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
    wrongs = [_judge_rate(publisher, 0.001), *_judge_messages(publisher.sent, NAMES, world.displayed)]
    for finding in wrongs:
        if not finding.right:
            return wrong(f"{when}, {finding.text}", RESTART)
    return right(f"{when} it begins anew")


def judge_stamps(sent: Sequence[tuple[Any, Moment]]) -> Finding:
    """Look whether the messages' stamps are simulated time."""
    stamps = [m.header.stamp.sec * SECOND + m.header.stamp.nanosec for m, _ in sent]
    times = [moment.time_ns for _, moment in sent]
    if _equal(stamps, times):
        return right("the stamps are simulated time")
    if not any(stamps) and times[-1] < SECOND:
        return wrong("the stamps are 0", NO_STAMP)
    if min(stamps) > 1_000_000 * SECOND or "clock" in watch.noted:
        return wrong("the stamps are not simulated time", WALL_CLOCK)
    guesses = (
        ([0] * len(times), "the stamps are 0", NO_STAMP),
        ([time - time % SECOND for time in times], "the stamps are whole seconds", ONLY_SECONDS),
        ([time % SECOND for time in times], "the stamps begin at 0 in every second", ONLY_NANOSECONDS),
        ([time // 1000 for time in times], "the stamps are a thousandth of it", UNIT.format("microseconds")),
        ([time // 1_000_000 for time in times], "the stamps are a millionth of it", UNIT.format("milliseconds")),
        ([time // SECOND for time in times], "the stamps are next to nothing", UNIT.format("seconds")),
        ([stamps[0]] * len(times), "the stamps are all the same", FIXED_STAMP),
        ([time + stamps[-1] - times[-1] for time in times], "the stamps are of another time", OLD_STAMP),
    )
    for guess, text, cause in guesses:
        if _equal(stamps, guess):
            return wrong(text, cause)
    return wrong("the stamps are not the simulated time of sending", OTHER_STAMP)


def _equal(stamps: Sequence[int], times: Sequence[int]) -> bool:
    """Whether stamps are times [ns], but for what a float may lose."""
    return all(abs(a - b) <= 2 for a, b in zip(stamps, times))


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
