"""Mistakes of every kind that learners make, each told from the others; and odd answers that are right."""

from __future__ import annotations

import functools
import math
import threading
import time
from collections import deque

import pytest
from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.joint_state_publisher import SlowPublisher, ThriftyPublisher, publish, thrift
from tutorial.checks.joint_state_subscriber import CalmViewer, MyViewer, keep_up, show
from tutorial.controllers.joint_state_publisher import JointStatePublisher
from tutorial.joints import match_joints

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

# --- show


class ReadsTheNewest(MyViewer):
    def on_joint_state(self, message):
        self.message = message
        self.call_later(self.draw)

    def draw(self):
        self.update(self.message)


class NewestFirst(MyViewer):
    def configure(self, config):
        super().configure(config)
        self.waiting = []

    def on_joint_state(self, message):
        self.waiting.append(message)
        self.call_later(self.draw)

    def draw(self):
        self.update(self.waiting.pop())


class Matches(MyViewer):
    def update(self, message):
        self.body.set_joint_positions(self.matched(message))
        self.body.calc_forward_kinematics()
        self.body.notify_change()


class ByIndexAndName(Matches):
    def matched(self, message):
        return {j: q for j, n, q in zip(self.body.joint_names, message.name, message.position) if j == n}


class NoZeros(Matches):
    def matched(self, message):
        return {n: q for n, q in match_joints(self.body.joint_names, message)[0].items() if q}


class PassesNaN(Matches):
    def matched(self, message):
        return {n: q for n, q in zip(message.name, message.position) if n in self.body.joint_names}


class NaNDropsAll(Matches):
    def matched(self, message):
        return {} if any(map(math.isnan, message.position)) else match_joints(self.body.joint_names, message)[0]


class GoesByIndices(Matches):
    def matched(self, message):
        count = range(len(message.name))
        known = {message.name[i]: message.position[i] for i in count if message.name[i] in self.body.joint_names}
        return {n: q for n, q in known.items() if not math.isnan(q)}


class Negative(Matches):
    def matched(self, message):
        return {n: -q for n, q in match_joints(self.body.joint_names, message)[0].items()}


class OnlyNewerStamps(MyViewer):
    newest = -1.0

    def update(self, message):
        stamp = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
        if stamp > self.newest:
            self.newest = stamp
            super().update(message)


class LockWhileDrawing(MyViewer):
    def configure(self, config):
        self.lock = threading.Lock()
        super().configure(config)

    def on_joint_state(self, message):
        with self.lock:
            super().on_joint_state(message)

    def update(self, message):
        with self.lock:
            super().update(message)


class BodyOfTheClass(MyViewer):
    shown = None

    def configure(self, config):
        super().configure(config)
        BodyOfTheClass.shown = config.body

    def update(self, message):
        self.body = BodyOfTheClass.shown
        super().update(message)


class SetsByAPartial(MyViewer):
    def configure(self, config):
        self.body, self.node = config.body, config.node
        move = functools.partial(_move, config.body)
        self.subscription = self.node.create_subscription(JointState, f"{self.body.name}/joint_state", move, 1)


def _move(body, message):
    body.set_joint_positions(match_joints(body.joint_names, message)[0])


class PartInTheCallback(MyViewer):
    def on_joint_state(self, message):
        self.body.set_joint_positions(match_joints(self.body.joint_names, message)[0])
        self.call_later(self.body.notify_change)


class ForgetsTheMessage(MyViewer):
    def on_joint_state(self, message):
        self.call_later(self.update)


class ByATimer(MyViewer):
    def configure(self, config):
        self.message = None
        super().configure(config)
        self.timer = self.node.create_timer(0.01, self.tick)

    def on_joint_state(self, message):
        self.message = message

    def tick(self):
        if self.message is not None:
            self.call_later(self.update, self.message)


class AtMostAMillionPerSecond(MyViewer):
    last = float("-inf")

    def on_joint_state(self, message):
        now = time.perf_counter()
        if now - self.last > 1e-6:
            self.last = now
            super().on_joint_state(message)


SHOW = [
    (AtMostAMillionPerSecond, "dropped by time or by count"),
    (ReadsTheNewest, "takes the message from self"),
    (NewestFirst, "is taken first"),
    (ByIndexAndName, "the i-th joint of the body is compared"),
    (NoZeros, "0.0 is taken for nothing"),
    (PassesNaN, "NaN is set as a position"),
    (NaNDropsAll, "one NaN makes the whole message invalid"),
    (GoesByIndices, "an index goes beyond the end"),
    (Negative, "the sign is turned round"),
    (OnlyNewerStamps, "started again"),
    (LockWhileDrawing, "a lock is held while the body is moved and drawn"),
    (BodyOfTheClass, "BodyOfTheClass.shown is shared by all objects"),
    (SetsByAPartial, "the callback moves the body itself"),
    (PartInTheCallback, "posts only what comes after"),
    (ForgetsTheMessage, "gets too few arguments"),
    (ByATimer, "a timer posts"),
]

# --- keep_up


class Calm(CalmViewer):
    def configure(self, config):
        super().configure(config)
        self.call_later, self.newest, self.waits = config.call_later, None, False

    def draw(self, message):
        CalmViewer.update(self, message)


class ClearsInTheEnd(Calm):
    def on_joint_state(self, message):
        self.newest = message
        if not self.waits:
            self.waits = True
            self.call_later(self.update)

    def update(self):
        self.draw(self.newest)
        self.waits = False


class AsksBeforeItKeeps(Calm):
    def on_joint_state(self, message):
        if self.waits:
            self.newest = message
        else:
            self.newest, self.waits = message, True
            self.call_later(self.update)

    def update(self):
        message, self.waits = self.newest, False
        self.draw(message)


class SwapsWithoutALock(Calm):
    def on_joint_state(self, message):
        first = self.newest is None
        self.newest = message
        if first:
            self.call_later(self.update)

    def update(self):
        message = self.newest
        self.newest = None
        self.draw(message)


class LockedWhileDrawing(Calm):
    lock = threading.Lock()

    def on_joint_state(self, message):
        with self.lock:
            self.call_latest(0, self.update, message)

    def update(self, message):
        with self.lock:
            self.draw(message)


class NoneAsKey(Calm):
    def on_joint_state(self, message):
        self.call_latest(None, self.draw, message)


class NewKeys(Calm):
    def on_joint_state(self, message):
        self.call_latest(id(message), self.draw, message)


class KeyOfTheSecond(Calm):
    def on_joint_state(self, message):
        self.call_latest(message.header.stamp.sec, self.draw, message)


class RateLimit(Calm):
    last = float("-inf")

    def on_joint_state(self, message):
        now = time.monotonic()
        if now - self.last > 1e-6:
            self.last = now
            super().on_joint_state(message)


class DrawsAll(Calm):
    def configure(self, config):
        super().configure(config)
        self.inbox = deque()

    def on_joint_state(self, message):
        self.inbox.append(message)
        self.call_latest(0, self.update)

    def update(self):
        while self.inbox:
            self.draw(self.inbox.popleft())


class WaitingOnTheClass(Calm):
    posted = False

    def on_joint_state(self, message):
        self.newest = message
        if not WaitingOnTheClass.posted:
            WaitingOnTheClass.posted = True
            self.call_later(self.update)

    def update(self):
        WaitingOnTheClass.posted = False
        self.draw(self.newest)


class FirstStamp(Calm):
    begin = None

    def update(self, message):
        stamp = message.header.stamp.sec
        self.begin = stamp if self.begin is None else self.begin
        if stamp >= self.begin:
            self.draw(message)


class OnlyTheTank(Calm):
    def configure(self, config):
        super().configure(config)
        self.node.destroy_subscription(self.subscription)
        config.node.taps.clear()
        self.subscription = self.node.create_subscription(JointState, "Tank/joint_state", self.on_joint_state, 1)


KEEP_UP = [
    (OnlyTheTank, "The body's name is written into the topic"),
    (ClearsInTheEnd, "cleared too late, or asked too early"),
    (AsksBeforeItKeeps, "cleared too late, or asked too early"),
    (SwapsWithoutALock, "cleared too late, or asked too early"),
    (LockedWhileDrawing, "a lock is held while the body is moved and drawn"),
    (NoneAsKey, "the key is None"),
    (NewKeys, "the key differs from message to message"),
    (KeyOfTheSecond, "the key differs from message to message"),
    (RateLimit, "dropped by time or by count"),
    (DrawsAll, "all messages that wait are drawn"),
    (WaitingOnTheClass, "WaitingOnTheClass.posted is shared by all objects"),
    (FirstStamp, "started again"),
]

ALL = {publish: PUBLISH, thrift: THRIFT, show: SHOW, keep_up: KEEP_UP}


@pytest.mark.parametrize(
    ("exercise", "answer", "cause"),
    [(exercise, answer, cause) for exercise, wrongs in ALL.items() for answer, cause in wrongs],
    ids=lambda value: getattr(value, "__name__", getattr(value, "name", "")),
)
def test_each_kind_of_mistake_gets_its_cause(domain, exercise, answer, cause):
    verdict = exercise.judge(answer)
    assert not verdict.right, str(verdict)
    assert cause in verdict.causes[0], str(verdict)


class ClearsFirst(Calm):
    """A flag without a lock, which is cleared before the newest is taken."""

    def on_joint_state(self, message):
        self.newest = message
        if not self.waits:
            self.waits = True
            self.call_later(self.update)

    def update(self):
        self.waits = False
        self.draw(self.newest)


class TakesUnderALock(Calm):
    """A lock and what waits, which is taken out by the posted call: it may run only once."""

    def configure(self, config):
        self.lock = threading.Lock()
        super().configure(config)

    def on_joint_state(self, message):
        with self.lock:
            first, self.newest = self.newest is None, message
        if first:
            self.call_later(self.update)

    def update(self):
        with self.lock:
            message, self.newest = self.newest, None
        self.draw(message)


class OnePerMessage(MyViewer):
    """A queue, of which each posted call takes one."""

    def configure(self, config):
        self.inbox = deque()
        super().configure(config)

    def on_joint_state(self, message):
        self.inbox.append(message)
        self.call_later(self.draw)

    def draw(self):
        self.update(self.inbox.popleft())


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
    (show, OnePerMessage),
    (keep_up, ClearsFirst),
    (keep_up, TakesUnderALock),
]


@pytest.mark.parametrize(("exercise", "answer"), RIGHT, ids=lambda value: getattr(value, "name", ""))
def test_odd_answers_that_are_right_are_right(domain, exercise, answer):
    verdict = exercise.judge(answer)
    assert verdict.right, str(verdict)
