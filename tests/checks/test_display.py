"""The exercises `show` and `keep_up`: every wrong answer is told from the others."""

from __future__ import annotations

import math
import time

import pytest
from sensor_msgs.msg import JointState

from tutorial.checks.joint_state_subscriber import CalmViewer, MyViewer, keep_up, show
from tutorial.joints import match_joints


class FromTheCallback(MyViewer):
    def on_joint_state(self, message):
        self.update(message)


class CalledAtOnce(MyViewer):
    def on_joint_state(self, message):
        self.call_later(self.update(message))


class NeverPosted(MyViewer):
    def on_joint_state(self, message):
        self.message = message


class PostsItself(MyViewer):
    def on_joint_state(self, message):
        self.call_later(self.on_joint_state, message)


class HardCoded(MyViewer):
    def configure(self, config):
        self.node = config.node
        super().configure(config)
        self.node.destroy_subscription(self.subscription)
        config.node.taps.clear()
        topic = "/Tank/joint_state"
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1)


class WrongTopic(MyViewer):
    def configure(self, config):
        self.node = config.node
        self.body, self.call_later = config.body, config.call_later
        topic = f"/{self.body.name}/joint_states"
        self.subscription = config.node.create_subscription(JointState, topic, self.on_joint_state, 1)


class NoKinematics(MyViewer):
    def update(self, message):
        self.body.set_joint_positions(match_joints(self.body.joint_names, message)[0])
        self.body.notify_change()


class NoNotice(MyViewer):
    def update(self, message):
        self.body.set_joint_positions(match_joints(self.body.joint_names, message)[0])
        self.body.calc_forward_kinematics()


class NoticeTooEarly(MyViewer):
    def update(self, message):
        self.body.notify_change()
        self.body.set_joint_positions(match_joints(self.body.joint_names, message)[0])
        self.body.calc_forward_kinematics()


class NotSet(MyViewer):
    def update(self, message):
        match_joints(self.body.joint_names, message)
        self.body.calc_forward_kinematics()
        self.body.notify_change()


class Matching(MyViewer):
    def update(self, message):
        self.body.set_joint_positions(self.matched(message))
        self.body.calc_forward_kinematics()
        self.body.notify_change()


class ByIndex(Matching):
    def matched(self, message):
        return dict(zip(self.body.joint_names, message.position))


class InventsZeros(Matching):
    def matched(self, message):
        given = match_joints(self.body.joint_names, message)[0]
        return {name: given.get(name, 0.0) for name in self.body.joint_names}


class UnknownName(Matching):
    def matched(self, message):
        return dict(zip(message.name, message.position))


class OnlyTwoJoints(Matching):
    def matched(self, message):
        return match_joints(("TURRET_Y", "TURRET_P"), message)[0]


class KeepsListening(MyViewer):
    def unconfigure(self):
        pass


class WrongOrder(MyViewer):
    def update(self, message):
        positions, _ = match_joints(self.body.joint_names, message)
        self.body.calc_forward_kinematics()
        self.body.set_joint_positions(positions)
        self.body.notify_change()


class TwoThings(MyViewer):
    def update(self, message):
        positions = match_joints(self.body.joint_names, message)
        self.body.set_joint_positions(positions)


class PostsWithoutSelf(MyViewer):
    def update(message):  # noqa: N805
        message.body.notify_change()


class ListensWithoutSelf(MyViewer):
    def on_joint_state(message):  # noqa: N805
        message.call_later(message.update)


class CallsTheCallback(MyViewer):
    def configure(self, config):
        self.node = config.node
        self.body, self.call_later = config.body, config.call_later
        topic = f"{self.body.name}/joint_state"
        self.subscription = config.node.create_subscription(JointState, topic, self.on_joint_state(JointState()), 1)


class OnlyWhole(MyViewer):
    def update(self, message):
        if len(message.name) == len(self.body.joint_names):
            super().update(message)


SHOW = [
    (WrongOrder, "or called before set_joint_positions", "the links are where they were"),
    (TwoThings, "match_joints returns two things: positions, report = match_joints(...).", "update raised"),
    (PostsWithoutSelf, "self is missing: def update(self, message):", "update raised TypeError"),
    (ListensWithoutSelf, "self is missing: def on_joint_state(self, message):", "cannot take a message"),
    (CallsTheCallback, "give it without parentheses, self.on_joint_state.", "configure: create_subscription is given"),
    (OnlyWhole, "does not name all joints is dropped", "a message with only TURRET_P: nothing moves"),
    (FromTheCallback, "the callback moves the body itself", "touched on the executor's thread"),
    (CalledAtOnce, "the parentheses call it at once", "touched on the executor's thread"),
    (NeverPosted, "the callback posts nothing", "nothing is posted"),
    (PostsItself, "the callback posts itself", "it posts another call, without end"),
    (HardCoded, "written into the topic", "on a body called Lift, it listens to /Tank/joint_state"),
    (WrongTopic, "the topic's name is another", "/Tank/joint_states, not /Tank/joint_state"),
    (NoKinematics, "calc_forward_kinematics() is missing", "the links are where they were"),
    (NoNotice, "notify_change() is missing", "nobody is told"),
    (NoticeTooEarly, "notify_change comes too early", "told before the body has moved"),
    (NotSet, "computed but not set", "the joints stay where they are"),
    (ByIndex, "match them by name", "exchanged"),
    (InventsZeros, "is set to 0", "a message with only TURRET_P"),
    (UnknownName, "match_joints leaves such names out", "ANTENNA"),
    (OnlyTwoJoints, "a name is typed", "on Lift, a message comes, and the joints stay where they are"),
    (CalmViewer, "call_later keeps all, in order", "five messages that wait together"),
    (KeepsListening, "self.node.destroy_subscription(self.subscription)", "it still listens"),
]


@pytest.mark.parametrize(("answer", "cause", "text"), SHOW, ids=lambda value: getattr(value, "__name__", ""))
def test_a_wrong_viewer_gets_its_own_sentence(domain, answer, cause, text):
    verdict = show.judge(answer)
    assert not verdict.right
    assert len(verdict.causes) == 1, str(verdict)
    assert cause in verdict.causes[0], str(verdict)
    assert text in next(finding.text for finding in verdict.findings if not finding.right)


class QueueGrows(CalmViewer):
    def on_joint_state(self, message):
        self.call_later(self.update, message)

    def configure(self, config):
        super().configure(config)
        self.call_later = config.call_later


class KeyOfTheMessage(CalmViewer):
    def on_joint_state(self, message):
        self.call_latest(message.header.stamp.nanosec, self.update, message)


class DropsByTime(CalmViewer):
    def on_joint_state(self, message):
        if time.monotonic() - getattr(self, "last", 0.0) < 100.0 and message.header.stamp.nanosec > 99_000_000:
            return
        self.last = time.monotonic()
        super().on_joint_state(message)


class EveryTenth(CalmViewer):
    def on_joint_state(self, message):
        self.count = getattr(self, "count", -1) + 1
        if self.count < 5 or self.count % 10 == 0:
            super().on_joint_state(message)


class KeepsTheFirst(CalmViewer):
    def configure(self, config):
        super().configure(config)
        self.posted = False

    def on_joint_state(self, message):
        if not self.posted:
            self.posted = True
            super().on_joint_state(message)

    def update(self, message):
        self.posted = False
        super().update(message)


class Piecewise(CalmViewer):
    def on_joint_state(self, message):
        self.positions = getattr(self, "positions", {})
        for name, position in zip(message.name, message.position):
            self.positions[name] = position
        self.call_latest("Tank", self.update, None)

    def update(self, message):
        known = {n: q for n, q in tuple(self.positions.items()) if n in self.body.joint_names and not math.isnan(q)}
        self.body.set_joint_positions(known)
        self.body.calc_forward_kinematics()
        self.body.notify_change()


class Throttled(CalmViewer):
    """Leaves out what comes within 100 s of the last one."""

    last = float("-inf")

    def on_joint_state(self, message):
        if time.monotonic() - self.last > 100.0:
            self.last = time.monotonic()
            super().on_joint_state(message)


class EveryThird(CalmViewer):
    count = 0

    def on_joint_state(self, message):
        self.count += 1
        if self.count % 3 == 0:
            super().on_joint_state(message)


class ThrottledInUpdate(CalmViewer):
    last = float("-inf")

    def update(self, message):
        if time.monotonic() - self.last > 100.0:
            self.last = time.monotonic()
            super().update(message)


class DropsTheUnknownByCount(CalmViewer):
    def on_joint_state(self, message):
        self.count = getattr(self, "count", 0) + 1
        if self.count != 3:
            super().on_joint_state(message)


class NoKey(CalmViewer):
    def on_joint_state(self, message):
        self.call_latest(self.update, message)


class OnlyTheFunction(CalmViewer):
    def on_joint_state(self, message):
        self.call_latest(self.update)


class CallsUpdate(CalmViewer):
    def on_joint_state(self, message):
        self.call_latest(self.body.name, self.update(message))


KEEP_UP = [
    (Throttled, "dropped by time or by count", "a message with only TURRET_P: nothing is posted"),
    (EveryThird, "dropped by time or by count", "nothing is posted to the main thread"),
    (DropsTheUnknownByCount, "dropped by time or by count", "the unknown name ANTENNA: nothing is posted"),
    (ThrottledInUpdate, "dropped by time or by count", "nothing moves"),
    (NoKey, "call_latest takes a key first: self.call_latest(self.body.name, self.update, message).", "without a key"),
    (OnlyTheFunction, "call_latest takes a key first", "without a key"),
    (CallsUpdate, "apart, self.call_latest(self.body.name, self.update, message)", "touched on the executor's thread"),
    (QueueGrows, "call_later, which keeps every call", "50 calls wait"),
    (KeyOfTheMessage, "the key differs from message to message", "50 calls wait"),
    (DropsByTime, "dropped by time or by count", "the last one is not shown"),
    (EveryTenth, "dropped by time or by count", "a message with NaN for TURRET_Y: it shows"),
    (KeepsTheFirst, "the first of them is kept", "the last one is not shown"),
    (Piecewise, "piece by piece", "half of each is shown"),
    (NoKinematics, "calc_forward_kinematics() is missing", "the links are where they were"),
]


@pytest.mark.parametrize(("answer", "cause", "text"), KEEP_UP, ids=lambda value: getattr(value, "__name__", ""))
def test_a_viewer_that_does_not_keep_up_gets_its_own_sentence(domain, answer, cause, text):
    verdict = keep_up.judge(answer)
    assert not verdict.right
    assert cause in verdict.causes[0], str(verdict)
    assert text in next(finding.text for finding in verdict.findings if not finding.right)


class OneKeyForAll(CalmViewer):
    """Right: keys are each controller's own."""

    def on_joint_state(self, message):
        self.call_latest("joints", self.update, message)


class WithAnAttribute(CalmViewer):
    """Right: the newest message is an attribute, replaced as a whole."""

    def on_joint_state(self, message):
        self.message = message
        self.call_latest("joints", self.update, None)

    def update(self, message):
        super().update(self.message)


@pytest.mark.parametrize(
    ("exercise", "answer"),
    [(show, MyViewer), *((keep_up, a) for a in (CalmViewer, OneKeyForAll, WithAnAttribute))],
)
def test_right_viewers_are_right(domain, exercise, answer):
    verdict = exercise.judge(answer)
    assert verdict.right, str(verdict)
