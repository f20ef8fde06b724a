"""Mistakes of every kind that learners make, each told from the others; and odd answers that are right."""

from __future__ import annotations

import math
import threading
import time
from collections import deque

import pytest
from rclpy.time import Time
from sensor_msgs.msg import JointState, Joy

from tutorial.checks.joint_state_publisher import SlowPublisher, ThriftyPublisher, publish, thrift
from tutorial.checks.tank_controller import GentleTank, drive
from tutorial.controllers.joint_state_publisher import JointStatePublisher
from tutorial.handoff import Latest

# --- drive


class Queued(GentleTank):
    def configure(self, config):
        super().configure(config)
        self.waiting, self.last = deque(), Joy()

    def on_joy(self, message):
        self.waiting.append(message)

    def control(self):
        if self.waiting:
            self.last = self.waiting.popleft()
        self.joy.put(self.last)
        super().control()


class TakesItOut(GentleTank):
    def control(self):
        super().control()
        self.joy.put(Joy())


class Smoothed(GentleTank):
    def control(self):
        before = self.track_l.ctrl, self.track_r.ctrl
        super().control()
        self.track_l.ctrl = 0.5 * (before[0] + self.track_l.ctrl)
        self.track_r.ctrl = 0.5 * (before[1] + self.track_r.ctrl)


class OnlyAhead(GentleTank):
    def control(self):
        x, y = (axis if axis > 0.3 else 0.0 for axis in [*self.joy.get().axes, 0.0, 0.0][:2])
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


class FourAxes(GentleTank):
    def on_joy(self, message):
        if len(message.axes) == 4:
            self.joy.put(message)


class AllOrNothing(GentleTank):
    def control(self):
        axes = self.joy.get().axes
        x, y = axes[:2] if len(axes) > 1 else (0.0, 0.0)
        x, y = (axis if abs(axis) > 0.3 else 0.0 for axis in (x, y))
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


class ForgetsAtTheStart(GentleTank):
    def initialize(self, io):
        super().initialize(io)
        self.joy.put(Joy())


class KnowsTheBodyTooLate(GentleTank):
    def on_joy(self, message):
        self.tracks = (self.track_l, self.track_r)
        self.joy.put(message)


_newest = Latest(Joy())


class GlobalLatest(GentleTank):
    def configure(self, config):
        super().configure(config)
        self.joy = _newest


class ExpectsSix(GentleTank):
    def control(self):
        if len(self.joy.get().axes) > 4:
            raise IndexError("too many")
        super().control()


class TwoSubscriptions(GentleTank):
    def configure(self, config):
        super().configure(config)
        super().configure(config)


class DestroysTheNode(GentleTank):
    def unconfigure(self):
        self.node.destroy_node()


class NumberForATrack(GentleTank):
    def control(self):
        self.track_l = self.track_r = 1.0


class DropsWhatComesSoon(GentleTank):
    last = float("-inf")

    def on_joy(self, message):
        if time.monotonic() - self.last > 1e-6:
            self.last = time.monotonic()
            super().on_joy(message)


class StopsAfterAWhile(GentleTank):
    def on_joy(self, message):
        self.heard = time.time_ns()
        super().on_joy(message)

    def control(self):
        if time.time_ns() - getattr(self, "heard", 0) > 5_000_000_000:
            self.joy.put(Joy())
        super().control()


DRIVE = [
    (DropsWhatComesSoon, "dropped by time"),
    (StopsAfterAWhile, "or for a while, and then for nothing"),
    (Queued, "messages wait in a queue"),
    (TakesItOut, "a message counts for one step only"),
    (Smoothed, "the speeds are smoothed"),
    (OnlyAhead, "abs is missing"),
    (FourAxes, "a message with few axes is dropped"),
    (AllOrNothing, "a message with few axes counts as rest"),
    (ForgetsAtTheStart, "initialize throws away what has come before"),
    (KnowsTheBodyTooLate, "read before anything has set it"),
    (GlobalLatest, "_newest is shared by all objects"),
    (ExpectsSix, "there may be more"),
    (TwoSubscriptions, "configure makes two"),
    (DestroysTheNode, "config.node belongs to the whole program"),
    (NumberForATrack, "puts a number in the place of the actuator"),
]

# --- publish


class Publishes(SlowPublisher):
    """Right; each wrong answer changes one of its parts."""

    def control(self):
        if self.io.step % self.steps_per_message == 0:
            self.publisher.publish(self.message())

    def message(self):
        message = JointState(name=[joint.name for joint in self.joints])
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        message.position = [joint.position for joint in self.joints]
        message.velocity = [joint.velocity for joint in self.joints]
        message.effort = [joint.effort for joint in self.joints]
        return message


class OneStepLess(Publishes):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_message -= 1


class OneStepMore(Publishes):
    def initialize(self, io):
        super().initialize(io)
        self.left = 0

    def control(self):
        if self.left == 0:
            self.publisher.publish(self.message())
            self.left = self.steps_per_message
        else:
            self.left -= 1


class DueForEver(Publishes):
    def configure(self, config):
        super().configure(config)
        self.due = 0

    def control(self):
        if self.io.time_ns >= self.due:
            self.due += 40_000_000
            self.publisher.publish(self.message())


class NanosecondsOnly(Publishes):
    def message(self):
        message = super().message()
        message.header.stamp.sec = 0
        return message


class Milliseconds(Publishes):
    def message(self):
        message = super().message()
        message.header.stamp = Time(nanoseconds=self.io.time_ns // 1_000_000).to_msg()
        return message


class GrowingLists(Publishes):
    def initialize(self, io):
        super().initialize(io)
        self.names, self.positions = [], []

    def message(self):
        message = super().message()
        self.names += message.name
        self.positions += message.position
        message.name, message.position = self.names, self.positions
        return message


class OneMessageBehind(Publishes):
    before = None

    def message(self):
        message = super().message()
        positions, self.before = list(message.position), message.position
        message.position = getattr(self, "last", positions)
        self.last = positions
        return message


class RoundedPositions(Publishes):
    def message(self):
        message = super().message()
        message.position = [round(position, 3) for position in message.position]
        return message


class FirstTwo(Publishes):
    def initialize(self, io):
        super().initialize(io)
        self.joints = self.joints[:2]


class PublisherOfTheClass(Publishes):
    made = None

    def configure(self, config):
        super().configure(config)
        PublisherOfTheClass.made = self.publisher

    def control(self):
        if self.io.step % self.steps_per_message == 0:
            PublisherOfTheClass.made.publish(self.message())


class WaitsInATimerThread(Publishes):
    def initialize(self, io):
        super().initialize(io)
        self.ready = threading.Thread(target=self.message)
        self.ready.start()


class BesideTheCoursesOwn(JointStatePublisher):
    def configure(self, config):
        super().configure(config)
        self.publisher = config.node.create_publisher(JointState, f"{config.body.name}/turret", 1)

    def initialize(self, io):
        super().initialize(io)
        self.steps_per_message *= 2


class NothingKept(Publishes):
    def configure(self, config):
        config.node.create_publisher(JointState, f"{config.body.name}/turret", 1)


class ArgumentsForInit(Publishes):
    def __init__(self, config):
        self.config = config


class NoEffort(Publishes):
    def message(self):
        message = super().message()
        message.effort = [0.0] * len(message.name)
        return message


class OneMessageForEach(Publishes):
    def control(self):
        every, joints = self.joints, [[joint] for joint in self.joints]
        for self.joints in joints:
            super().control()
        self.joints = every


PUBLISH = [
    (NoEffort, "effort is filled with zeros"),
    (OneMessageForEach, "there is a message for each joint"),
    (OneStepLess, "the count is off by one"),
    (OneStepMore, "the count is off by one"),
    (DueForEver, "kept from the run before"),
    (NanosecondsOnly, "only nanosec is set"),
    (Milliseconds, "milliseconds for nanoseconds"),
    (GrowingLists, "the lists grow from message to message"),
    (OneMessageBehind, "the numbers of the message before"),
    (RoundedPositions, "the numbers are rounded"),
    (FirstTwo, "or how many there are"),
    (PublisherOfTheClass, "PublisherOfTheClass.made is shared by all objects"),
    (WaitsInATimerThread, "a thread of its own"),
    (BesideTheCoursesOwn, "configure makes two"),
    (NothingKept, "read before anything has set it"),
    (ArgumentsForInit, "__init__ is given nothing"),
]

# --- thrift


class Thrifty(ThriftyPublisher):
    """Right; each wrong answer changes one of its parts."""

    def control(self):
        if self.io.step % self.steps_per_look == 0:
            self.look({joint.name: joint.position for joint in self.io.body.joints})

    def look(self, positions):
        news = {n: q for n, q in positions.items() if n not in self.sent or self.differs(q, self.sent[n])}
        if news:
            self.send(news)
            self.sent.update(news)

    def differs(self, a, b):
        return abs(a - b) > 0.001

    def send(self, news):
        message = JointState(name=list(news), position=list(news.values()))
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        self.publisher.publish(message)


class AfterTheLastMessage(Thrifty):
    left = 0

    def control(self):
        self.left -= 1
        if self.left < 0:
            before = dict(self.sent)
            self.look({joint.name: joint.position for joint in self.io.body.joints})
            self.left = self.steps_per_look - 1 if self.sent != before else 0


class TwentySteps(Thrifty):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_look = 20


class CutOff(Thrifty):
    def differs(self, a, b):
        return int(a * 1000) != int(b * 1000)


class LastOnly(Thrifty):
    def look(self, positions):
        name = None
        for n, q in positions.items():
            if n not in self.sent or self.differs(q, self.sent[n]):
                name = n
        if name is not None:
            self.send({name: positions[name]})
            self.sent[name] = positions[name]


class LatestLookForAll(Thrifty):
    def look(self, positions):
        known = dict(self.sent)
        self.sent = positions
        news = {n: q for n, q in positions.items() if n not in known or self.differs(q, self.sent[n])}
        if news:
            self.send(news)


class SentOfTheClass(Thrifty):
    noted: dict[str, float] = {}  # the mistake

    def initialize(self, io):
        super().initialize(io)
        SentOfTheClass.noted.clear()
        self.sent = SentOfTheClass.noted

    def look(self, positions):
        self.sent = SentOfTheClass.noted
        super().look(positions)
        if "TURRET_Y" in positions:
            self.sent.clear()


class SendsTheOldOnes(Thrifty):
    def send(self, news):
        super().send({n: self.sent.get(n, q) for n, q in news.items()})


class InDegrees(Thrifty):
    def send(self, news):
        super().send({n: math.degrees(q) for n, q in news.items()})


class TypedJoints(Thrifty):
    def control(self):
        if self.io.step % self.steps_per_look == 0:
            self.look({n: self.io.body.joint(n).position for n in ("BRIDGE", "SLEW", "LUFF")})


class DueSinceConfigure(Thrifty):
    def configure(self, config):
        super().configure(config)
        self.due = 0

    def control(self):
        if self.io.time_ns >= self.due:
            self.due += 20_000_000
            self.look({joint.name: joint.position for joint in self.io.body.joints})


THRIFT = [
    (AfterTheLastMessage, "counted from the last message"),
    (TwentySteps, "written down for 1 ms"),
    (CutOff, "truncated positions are compared"),
    (LastOnly, "only the last joint that has moved is named"),
    (LatestLookForAll, "what was sent is never different"),
    (SentOfTheClass, "SentOfTheClass.noted is shared by all objects"),
    (SendsTheOldOnes, "the position that was sent before"),
    (InDegrees, "converted to degrees"),
    (TypedJoints, "the joints' names are typed"),
    (DueSinceConfigure, "kept from the run before"),
]

ALL = {drive: DRIVE, publish: PUBLISH, thrift: THRIFT}


@pytest.mark.parametrize(
    ("exercise", "answer", "cause"),
    [(exercise, answer, cause) for exercise, wrongs in ALL.items() for answer, cause in wrongs],
    ids=lambda value: getattr(value, "__name__", getattr(value, "name", "")),
)
def test_each_kind_of_mistake_gets_its_cause(domain, exercise, answer, cause):
    verdict = exercise.judge(answer)
    assert not verdict.right, str(verdict)
    assert cause in verdict.causes[0], str(verdict)


class FloatDeadline(Publishes):
    """Simulated time as a float, with its rounding."""

    def initialize(self, io):
        super().initialize(io)
        self.due = io.time

    def control(self):
        if self.io.time >= self.due:
            self.due += 0.04
            self.publisher.publish(self.message())

    def message(self):
        message = super().message()
        message.header.stamp = Time(nanoseconds=int(self.io.time * 1e9)).to_msg()
        return message


class LookLater(Thrifty):
    """Looks 50 times a second, but not at step 0."""

    def control(self):
        if self.io.step % self.steps_per_look == self.steps_per_look // 2:
            self.look({joint.name: joint.position for joint in self.io.body.joints})


RIGHT = [
    (publish, Publishes),
    (publish, FloatDeadline),
    (thrift, Thrifty),
    (thrift, LookLater),
]


@pytest.mark.parametrize(("exercise", "answer"), RIGHT, ids=lambda value: getattr(value, "name", ""))
def test_odd_answers_that_are_right_are_right(domain, exercise, answer):
    verdict = exercise.judge(answer)
    assert verdict.right, str(verdict)
