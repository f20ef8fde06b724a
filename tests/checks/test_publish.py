"""The exercises `publish` and `thrift`: every wrong answer is told from the others."""

from __future__ import annotations

from math import degrees

import pytest
from rclpy.time import Time
from sensor_msgs.msg import JointState, Joy

from tutorial.checks.joint_state_publisher import SlowPublisher, ThriftyPublisher, publish, thrift


class Base(SlowPublisher):
    """Right; each wrong answer changes one of its parts."""

    topic = "{}/turret"
    rate = 25

    def configure(self, config):
        self.node = config.node
        self.publisher = config.node.create_publisher(JointState, self.topic.format(config.body.name), 1)

    def initialize(self, io):
        super().initialize(io)
        self.steps_per_message = round(1 / (self.rate * io.time_step))

    def control(self):
        if self.io.step % self.steps_per_message == 0:
            self.publisher.publish(self.message())

    def message(self):
        message = JointState()
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        message.name = [joint.name for joint in self.joints]
        message.position = [joint.position for joint in self.joints]
        message.velocity = [joint.velocity for joint in self.joints]
        message.effort = [joint.effort for joint in self.joints]
        return message


class WrongTopic(Base):
    topic = "{}/joint_state"


class HardCoded(Base):
    topic = "Tank/turret"


class WrongType(Base):
    def configure(self, config):
        self.node = config.node
        self.publisher = config.node.create_publisher(Joy, "Rover/turret", 1)


class EveryStep(Base):
    def control(self):
        self.publisher.publish(self.message())


class OldRate(Base):
    rate = 50


class OtherRate(Base):
    rate = 10


class FixedSteps(Base):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_message = 40


class ByTimer(Base):
    def configure(self, config):
        self.node = config.node
        super().configure(config)
        self.timer = config.node.create_timer(0.04, self.tick)

    def tick(self):
        if hasattr(self, "io"):
            self.publisher.publish(self.message())

    def control(self):
        self.time = self.io.time


class Never(Base):
    def control(self):
        if self.io.step % self.steps_per_message == 1000:
            self.publisher.publish(self.message())


class NoStamp(Base):
    def message(self):
        message = super().message()
        message.header.stamp = Time().to_msg()
        return message


class WallClock(Base):
    def message(self):
        message = super().message()
        message.header.stamp = Time(seconds=1_700_000_000).to_msg()
        return message


class OneStepLater(Base):
    def message(self):
        message = super().message()
        message.header.stamp.nanosec += 1_000_000
        return message


class Degrees(Base):
    def message(self):
        message = super().message()
        message.position = [degrees(position) for position in message.position]
        return message


class NamesTurnedRound(Base):
    def message(self):
        message = super().message()
        message.name = message.name[::-1]
        return message


class Sorted(Base):
    def initialize(self, io):
        super().initialize(io)
        self.joints = sorted(self.joints, key=lambda joint: joint.name)


class PositionsExchanged(Base):
    def message(self):
        message = super().message()
        message.position = message.position[::-1]
        return message


class NoNames(Base):
    def message(self):
        message = super().message()
        message.name = []
        return message


class Prefixed(Base):
    def message(self):
        message = super().message()
        message.name = [f"Rover/{name}" for name in message.name]
        return message


class NoVelocity(Base):
    def message(self):
        message = super().message()
        message.velocity = []
        return message


class ShortEffort(Base):
    def message(self):
        message = super().message()
        message.effort = message.effort[:1]
        return message


class VelocityForEffort(Base):
    def message(self):
        message = super().message()
        message.effort = message.velocity
        return message


class Stale(Base):
    def initialize(self, io):
        super().initialize(io)
        self.positions = [joint.position for joint in self.joints]

    def message(self):
        message = super().message()
        message.position = self.positions
        return message


class TypedNames(Base):
    def message(self):
        message = super().message()
        message.name = ["TURRET_Y", "TURRET_P"]
        return message


class TypedJoints(Base):
    def initialize(self, io):
        super().initialize(io)
        self.joints = [io.body.joint(name) for name in ("TURRET_Y", "TURRET_P")]


class FixedAtAnotherRate(Base):
    def initialize(self, io):
        super().initialize(io)
        self.steps_per_message = 20


class KeepsItsPublisher(Base):
    def unconfigure(self):
        self.publisher = None


class Misspells(Base):
    def control(self):
        self.publisher.pubish(self.message())


WRONG = [
    (TypedNames, "the joints' names are typed", "on the crane Lift, the names are TURRET_Y, TURRET_P, not BRIDGE"),
    (TypedJoints, "the joints' names are typed", "on the crane Lift: initialize raised TutorialError"),
    (
        KeepsItsPublisher,
        "does not call self.node.destroy_publisher(self.publisher)",
        "after unconfigure it still has its publisher",
    ),
    (Misspells, "Did you mean 'publish'?", "control raised AttributeError"),
    (WrongTopic, 'f"{config.body.name}/turret"', "it publishes on /Rover/joint_state, not /Rover/turret"),
    (HardCoded, "name is written into the topic", "on a body called Rover, it publishes on /Tank/turret"),
    (WrongType, "of the type JointState", "publishes messages of the type Joy"),
    (EveryStep, "publishes at every step", "1000 times per simulated second, not 25"),
    (OldRate, "the rate of JointStatePublisher", "50 times per simulated second, not 25"),
    (OtherRate, "the period is another", "10 times per simulated second, not 25"),
    (FixedSteps, "written down for 1 ms", "with steps of 2 ms"),
    (ByTimer, "a timer publishes", "from a timer"),
    (Never, "control never comes to publish", "no message was sent"),
    (NoStamp, "the stamp is left out", "the stamps are 0"),
    (WallClock, "the wall clock's time", "not simulated time"),
    (OneStepLater, "that of another step", "the stamps are of another time"),
    (Degrees, "converted to degrees", "position is not what the joints do"),
    (NamesTurnedRound, "keep the order", "the names are TURRET_P, TURRET_Y"),
    (Sorted, "sorted or turned round", "the names are TURRET_P, TURRET_Y"),
    (PositionsExchanged, "names are in one order and the numbers in another", "position is not"),
    (NoNames, "message.name is left out", "no names"),
    (Prefixed, "put before the joint's", "Rover/TURRET_Y"),
    (NoVelocity, "velocity is left out or cut", "velocity has 0 numbers for 2 names"),
    (ShortEffort, "effort is left out or cut", "effort has 1 number for 2 names"),
    (VelocityForEffort, "effort is filled with velocity", "effort is not what the joints do"),
    (Stale, "read once and kept", "position is not"),
]


@pytest.mark.parametrize(("answer", "cause", "text"), WRONG, ids=lambda value: getattr(value, "__name__", ""))
def test_a_wrong_publisher_gets_its_own_sentence(domain, answer, cause, text):
    verdict = publish.judge(answer)
    assert not verdict.right
    assert cause in verdict.causes[0], str(verdict)
    assert text in next(finding.text for finding in verdict.findings if not finding.right)


@pytest.mark.parametrize("answer", [EveryStep, OldRate, OtherRate])
def test_a_rate_that_follows_the_time_step_is_wrong_once(domain, answer):
    verdict = publish.judge(answer)
    assert len(verdict.causes) == 1, str(verdict)
    assert "2 ms" not in str(verdict)


def test_a_number_of_steps_that_is_written_down_is_never_right_by_accident(domain):
    verdict = publish.judge(FixedAtAnotherRate)
    assert [finding.text for finding in verdict.findings if "2 ms" in finding.text and finding.right] == []
    assert "written down for 1 ms" in verdict.causes[1]


class OneMessage(Base):
    """Right: one message object, filled again and again."""

    def initialize(self, io):
        super().initialize(io)
        self.reused = JointState(name=[joint.name for joint in self.joints])

    def message(self):
        fresh, message = super().message(), self.reused
        message.header = fresh.header
        message.position, message.velocity, message.effort = fresh.position, fresh.velocity, fresh.effort
        return message


class ByTime(Base):
    """Right: it goes by simulated time, with a little rounding."""

    def initialize(self, io):
        super().initialize(io)
        self.next = 0.0

    def control(self):
        if self.io.time >= self.next:
            self.next += 0.04
            self.publisher.publish(self.message())


@pytest.mark.parametrize("answer", [SlowPublisher, Base, OneMessage, ByTime])
def test_right_publishers_are_right(domain, answer):
    verdict = publish.judge(answer)
    assert verdict.right, str(verdict)


class Thrifty(ThriftyPublisher):
    """Right; each wrong answer changes one of its parts."""

    rate = 50
    threshold = 0.001

    def initialize(self, io):
        super().initialize(io)
        self.steps_per_look = round(1 / (self.rate * io.time_step))

    def control(self):
        if self.io.step % self.steps_per_look == 0:
            positions = {joint.name: joint.position for joint in self.io.body.joints}
            self.look(positions, {name: q for name, q in positions.items() if self.is_news(name, q)})

    def is_news(self, name, position):
        return name not in self.sent or abs(position - self.sent[name]) > self.threshold

    def look(self, positions, news):
        if news:
            self.send(news)
        self.sent.update(news)

    def send(self, news, positions=None):
        message = JointState(name=list(news), position=list(news.values()) if positions is None else positions)
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        self.publisher.publish(message)


class ComparesWithLastLook(Thrifty):
    def look(self, positions, news):
        super().look(positions, news)
        self.sent.update(positions)


class RemembersAll(Thrifty):
    def look(self, positions, news):
        super().look(positions, news)
        if news:
            self.sent.update(positions)


class NamesAll(Thrifty):
    def look(self, positions, news):
        if news:
            self.send(positions, list(news.values()))
        self.sent.update(news)


class SendsWhole(Thrifty):
    def look(self, positions, news):
        if news:
            super().look(positions, positions)


class SendsEmpty(Thrifty):
    def look(self, positions, news):
        self.send(news)
        self.sent.update(news)


class SendsAlways(Thrifty):
    def look(self, positions, news):
        super().look(positions, positions)


class ForgetsTheFirst(Thrifty):
    def initialize(self, io):
        super().initialize(io)
        self.sent = {joint.name: joint.position for joint in io.body.joints}


class ForgetsTheFirstAtControl(Thrifty):
    def look(self, positions, news):
        if not self.sent:
            self.sent.update(positions)
            return
        super().look(positions, news)


class RemembersNothing(Thrifty):
    def look(self, positions, news):
        if news:
            self.send(news)
        for name, position in news.items():
            self.sent.setdefault(name, position)


class NoAbs(Thrifty):
    def is_news(self, name, position):
        return name not in self.sent or position - self.sent[name] > 0.001


class AnyChange(Thrifty):
    threshold = 0.0


class EveryLookAStep(Thrifty):
    rate = 1000


class HalfAsOften(Thrifty):
    rate = 25


class PairsMixed(Thrifty):
    def look(self, positions, news):
        if news:
            self.send(news, list(positions.values())[: len(news)])
        self.sent.update(news)


class ThriftyWithoutStamp(Thrifty):
    def send(self, news, positions=None):
        self.publisher.publish(JointState(name=list(news), position=list(news.values())))


class Silent(Thrifty):
    def look(self, positions, news):
        self.sent.update(news)


class FilledWithZeros(Thrifty):
    def initialize(self, io):
        super().initialize(io)
        self.sent = {joint.name: 0.0 for joint in io.body.joints}


class FillsVelocity(Thrifty):
    def send(self, news, positions=None):
        message = JointState(name=list(news), position=list(news.values()), velocity=[0.0] * len(news))
        message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
        self.publisher.publish(message)


class Replaces(Thrifty):
    def look(self, positions, news):
        if news:
            self.send(news)
            self.sent = dict(news)


class ReplacesAlways(Thrifty):
    def look(self, positions, news):
        if news:
            self.send(news)
        self.sent = news


class ThriftyWithoutUnconfigure(Thrifty):
    def unconfigure(self):
        pass


class LooksWithoutSelf(Thrifty):
    def look(positions, news):  # noqa: N805
        positions.send(news)


WRONGLY_THRIFTY = [
    (ForgetsTheFirst, "self.sent is empty, and all are news", "the first message: nothing is sent; expected: 1"),
    (FilledWithZeros, "the first message is forgotten", "the first message: nothing is sent"),
    (FillsVelocity, "names and positions only", "velocity is not empty"),
    (Replaces, "self.sent.update(news) keeps", ""),
    (ReplacesAlways, "self.sent.update(news) keeps", ""),
    (ThriftyWithoutUnconfigure, "call self.node.destroy_publisher(self.publisher)", "still has its publisher"),
    (LooksWithoutSelf, "self is missing: def look(self, positions, news):", "control raised TypeError"),
    (ComparesWithLastLook, "a slow motion is then never sent", "LUFF creeps: nothing is sent"),
    (RemembersAll, "remember only those that were", "LUFF creeps on while SLEW moves"),
    (NamesAll, "all names are in the message, but only some", "1 message with BRIDGE and SLEW and LUFF and 1 position"),
    (SendsWhole, "the whole message is sent as soon as one", "SLEW moves: 1 message with BRIDGE and SLEW and LUFF"),
    (SendsEmpty, "even if no joint has moved", "nothing moves: 4 messages with nothing; expected: no message"),
    (SendsAlways, "every joint is sent every time", "nothing moves: 4 messages"),
    (ForgetsTheFirstAtControl, "the first message is forgotten", "the first message: nothing is sent"),
    (RemembersNothing, "what was sent is not remembered", "SLEW rests again"),
    (NoAbs, "compare abs(...)", "BRIDGE moves back: nothing is sent"),
    (AnyChange, "any change counts", "SLEW and LUFF creep, each by little: 1 message"),
    (EveryLookAStep, "looks at every step", "SLEW moves fast"),
    (HalfAsOften, "looks 25 times", ""),
    (PairsMixed, "from two different lists", "the position sent for"),
    (ThriftyWithoutStamp, "the stamp is left out", "the stamps are 0"),
    (Silent, "nothing was sent, so all joints are news", "nothing is sent"),
]


@pytest.mark.parametrize(("answer", "cause", "text"), WRONGLY_THRIFTY, ids=lambda value: getattr(value, "__name__", ""))
def test_a_wrong_thrift_gets_its_own_sentence(domain, answer, cause, text):
    verdict = thrift.judge(answer)
    assert not verdict.right
    assert cause in verdict.causes[0], str(verdict)
    assert text in next(finding.text for finding in verdict.findings if not finding.right)


def test_right_thrift_is_right(domain):
    for answer in (ThriftyPublisher, Thrifty):
        verdict = thrift.judge(answer)
        assert verdict.right, str(verdict)
