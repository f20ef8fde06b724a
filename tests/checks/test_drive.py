"""The exercise `drive`: every wrong answer is told from the others."""

from __future__ import annotations

import threading

import pytest
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState, Joy

from tutorial.checks.tank_controller import GentleTank, drive
from tutorial.controller import SimpleController
from tutorial.handoff import Latest


def dead(axis, width=0.3):
    return axis if abs(axis) > width else 0.0


class Formula(GentleTank):
    """A tank that is right but for how the speeds come from the axes."""

    def control(self):
        self.track_l.ctrl, self.track_r.ctrl = self.speeds([*self.joy.get().axes, 0.0, 0.0, 0.0, 0.0])

    def speeds(self, axes):
        x, y = dead(axes[0]), dead(axes[1])
        return y - 0.5 * x, y + 0.5 * x


class TurnSwapped(Formula):
    def speeds(self, axes):
        x, y = dead(axes[0]), dead(axes[1])
        return y + 0.5 * x, y - 0.5 * x


class OldNumbers(Formula):
    def speeds(self, axes):
        x, y = dead(axes[0]), dead(axes[1])
        return 2.0 * y - x, 2.0 * y + x


class TurnInFull(Formula):
    def speeds(self, axes):
        x, y = dead(axes[0]), dead(axes[1])
        return y - x, y + x


class NoDeadZone(Formula):
    def speeds(self, axes):
        return axes[1] - 0.5 * axes[0], axes[1] + 0.5 * axes[0]


class NarrowDeadZone(Formula):
    def speeds(self, axes):
        x, y = dead(axes[0], 0.2), dead(axes[1], 0.2)
        return y - 0.5 * x, y + 0.5 * x


class DeadZoneALittleWide(Formula):
    def speeds(self, axes):
        x, y = dead(axes[0], 0.33), dead(axes[1], 0.33)
        return y - 0.5 * x, y + 0.5 * x


class DeadZoneALittleNarrow(Formula):
    def speeds(self, axes):
        x, y = dead(axes[0], 0.28), dead(axes[1], 0.28)
        return y - 0.5 * x, y + 0.5 * x


class DeadZoneOfOneAxis(Formula):
    def speeds(self, axes):
        x, y = axes[0], dead(axes[1])
        return y - 0.5 * x, y + 0.5 * x


class AxesExchanged(Formula):
    def speeds(self, axes):
        y, x = dead(axes[0]), dead(axes[1])
        return y - 0.5 * x, y + 0.5 * x


class RightStick(Formula):
    def speeds(self, axes):
        return super().speeds(axes[2:])


class Backwards(Formula):
    def speeds(self, axes):
        return super().speeds([axes[0], -axes[1]])


class SwappedAndNoDeadZone(Formula):
    def speeds(self, axes):
        return axes[1] + 0.5 * axes[0], axes[1] - 0.5 * axes[0]


class OneTrack(GentleTank):
    def control(self):
        axes = [*self.joy.get().axes, 0.0, 0.0]
        self.track_l.ctrl = dead(axes[1]) - 0.5 * dead(axes[0])


class KeepsRunning(GentleTank):
    def control(self):
        axes = [*self.joy.get().axes, 0.0, 0.0]
        x, y = dead(axes[0]), dead(axes[1])
        if x or y:
            self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


class OtherFormula(Formula):
    def speeds(self, axes):
        return 0.123 * axes[0], 0.456 * axes[1]


class WrongTopic(GentleTank):
    def configure(self, config):
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = config.node.create_subscription(Joy, "joystick", self.on_joy, 1)


class WrongType(GentleTank):
    def configure(self, config):
        self.node = config.node
        self.subscription = config.node.create_subscription(JointState, "joy", self.on_joy, 1)


class NoSubscription(GentleTank):
    def configure(self, config):
        self.joy = Latest(Joy())


class FewAxes(GentleTank):
    def configure(self, config):
        super().configure(config)
        self.joy.put(Joy(axes=[0.0] * 4))

    def control(self):
        left_x, left_y, _, _ = self.joy.get().axes
        x, y = dead(left_x), dead(left_y)
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


class NothingYet(Formula):
    def configure(self, config):
        super().configure(config)
        self.joy.put(None)


class InCallback(GentleTank):
    def on_joy(self, message):
        x, y = dead(message.axes[0]), dead(message.axes[1])
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x

    def control(self):
        pass


class Piecewise(GentleTank):
    """The callback writes two numbers, one after the other."""

    def configure(self, config):
        self.node = config.node
        self.x = self.y = 0.0
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message):
        axes = [*message.axes, 0.0, 0.0]
        self.x = dead(axes[0])
        self.y = dead(axes[1])

    def control(self):
        self.track_l.ctrl, self.track_r.ctrl = self.y - 0.5 * self.x, self.y + 0.5 * self.x


class PiecewiseInPlace(Piecewise):
    def configure(self, config):
        self.node = config.node
        self.axes = [0.0, 0.0]
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message):
        for i, axis in enumerate([*message.axes, 0.0, 0.0][:2]):
            self.axes[i] = axis

    def control(self):
        x, y = map(dead, tuple(self.axes))
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


class ReadTwice(GentleTank):
    def on_joy(self, message):
        self.joy.put([*message.axes, 0.0, 0.0])

    def configure(self, config):
        super().configure(config)
        self.joy.put([0.0, 0.0])

    def control(self):
        x = dead(self.joy.get()[0])
        y = dead(self.joy.get()[1])
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


class TurretToo(Formula):
    def initialize(self, io):
        super().initialize(io)
        self.turret = io.body.joint("TURRET_Y")

    def control(self):
        super().control()
        self.turret.effort = 1.0


class Misspelled(SimpleController):
    def configure(self, config):
        self.node = config.node
        self.subscription = config.node.create_subscription(Joy, "joy", print, 1)

    def initialise(self, io):
        self.track_l = io.body.actuator("TRACK_L")


class NoControl(SimpleController):
    configure, on_joy, initialize = GentleTank.configure, GentleTank.on_joy, GentleTank.initialize
    unconfigure = GentleTank.unconfigure


class OneZoneUnlessBoth(Formula):
    def speeds(self, axes):
        x, y = axes[:2] if abs(axes[0]) > 0.3 and abs(axes[1]) > 0.3 else (0.0, 0.0)
        return y - 0.5 * x, y + 0.5 * x


class OneZoneUnlessEither(Formula):
    def speeds(self, axes):
        x, y = axes[:2] if abs(axes[0]) > 0.3 or abs(axes[1]) > 0.3 else (0.0, 0.0)
        return y - 0.5 * x, y + 0.5 * x


class OneZoneAndKeepsRunning(GentleTank):
    def control(self):
        x, y = [*self.joy.get().axes, 0.0, 0.0][:2]
        if abs(x) > 0.3 or abs(y) > 0.3:
            self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


class ControlWithoutSelf(GentleTank):
    def control():
        print()


class CallbackWithoutSelf(GentleTank):
    def on_joy(message):  # noqa: N805
        message.joy.put(message)


class CallbackIsACoroutine(GentleTank):
    async def on_joy(self, message):
        self.joy.put(message)


class ConfigureWithoutSelf(GentleTank):
    def configure(config):  # noqa: N805
        config.joy = Latest(Joy())


class HelperWithoutSelf(GentleTank):
    def control(self):
        self.set_tracks(0.0, 0.0)

    def set_tracks(left, right):  # noqa: N805
        left.ctrl = right


class SetsEffort(GentleTank):
    def control(self):
        self.track_l.effort = 1.0


class LocalJoy(GentleTank):
    def configure(self, config):
        self.node = config.node
        joy = Latest(Joy())
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, 1)
        del joy


class OnlyTheCallbackSetsIt(Formula):
    def configure(self, config):
        self.node = config.node
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message):
        self.message = message

    def control(self):
        self.track_l.ctrl, self.track_r.ctrl = self.speeds([*self.message.axes, 0.0, 0.0])


class Config(SimpleController):
    config = GentleTank.configure
    on_joy, initialize, control = GentleTank.on_joy, GentleTank.initialize, GentleTank.control
    unconfigure = GentleTank.unconfigure


class CallsTheCallback(GentleTank):
    def configure(self, config):
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy(Joy()), 1)


class CallsTheCallbackWithNothing(GentleTank):
    def configure(self, config):
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy(), 1)


class ClassForAnObject(GentleTank):
    def configure(self, config):
        super().configure(config)
        self.joy = Latest


class ClassForAMessage(GentleTank):
    def initialize(self, io):
        super().initialize(io)
        self.stamp = Joy.header.stamp


class NotCalled(GentleTank):
    def control(self):
        self.track_l.ctrl = self.joy.get.axes[0]


class NoUnconfigure(SimpleController):
    configure, on_joy = GentleTank.configure, GentleTank.on_joy
    initialize, control = GentleTank.initialize, GentleTank.control


class EmptyUnconfigure(GentleTank):
    def unconfigure(self):
        pass


class MisspelledUnconfigure(NoUnconfigure):
    unconfig = GentleTank.unconfigure


WRONG = [
    (
        TurnSwapped,
        "left and right are exchanged",
        "a turn to the left on the spot: the tracks run at +0.50 and -0.50 m/s; expected: -0.50 and +0.50 m/s",
    ),
    (OldNumbers, "numbers of TankController", "ahead: both tracks run at +2.00 m/s; expected: both at +1.00 m/s"),
    (TurnInFull, "left_x counts in full", "a turn to the left"),
    (NoDeadZone, "dead zone is missing", "stick at rest"),
    (NarrowDeadZone, "0.2; here it is 0.3", "0.25 to the left"),
    (DeadZoneALittleWide, "a little wide: it is 0.3", "0.31 back: both tracks stand still"),
    (DeadZoneALittleNarrow, "a little narrow: it is 0.3", "0.29 back, and half to the left"),
    (DeadZoneOfOneAxis, "left_x has no dead zone", "stick at rest"),
    (AxesExchanged, "the two axes are exchanged", "ahead: the tracks"),
    (RightStick, "reads the right stick", "ahead:"),
    (Backwards, "sign of left_y", "ahead: both tracks run at -1.00"),
    (OneTrack, "right track is forgotten", "ahead: the tracks run at +1.00 and 0"),
    (KeepsRunning, "the last speed stays", "stick at rest"),
    (OtherFormula, "Compare with left", "ahead:"),
    (WrongTopic, "topic's name is another: it is 'joy'", "it listens to /joystick, not /joy"),
    (WrongType, "messages are of the type Joy", "/joy"),
    (NoSubscription, "the call is missing", "subscribes to nothing"),
    (FewAxes, "takes for granted that there are axes", "a message with 2 axes: control raised ValueError"),
    (NothingYet, "begin with an empty message", "before the first message: control raised AttributeError"),
    (InCallback, "runs on the executor's thread", "the tracks change while control is not running"),
    (Piecewise, "piece by piece", "half of it is used"),
    (PiecewiseInPlace, "piece by piece", "half of it is used"),
    (ReadTwice, "control looks twice", "half of it is used"),
    (TurretToo, "drives only TRACK_L and TRACK_R", "it also commands TURRET_Y"),
    (Misspelled, "initialise should be initialize", "has no method initialize"),
    (OneZoneUnlessBoth, "share one dead zone: it holds for each axis for itself", "ahead:"),
    (OneZoneUnlessEither, "share one dead zone", "0.25 to the left"),
    (ControlWithoutSelf, "self is missing: def control(self):", "control raised TypeError"),
    (CallbackWithoutSelf, "self is missing: def on_joy(self, message):", "configure: on_joy cannot take a message"),
    (CallbackIsACoroutine, "a plain function, def", "configure: on_joy is a coroutine function, async def"),
    (ConfigureWithoutSelf, "self is missing: def configure(self, config):", "configure raised TypeError"),
    (HelperWithoutSelf, "self is missing: def set_tracks(self, left, right):", "control raised TypeError"),
    (SetsEffort, "An Actuator has ctrl, name.", "no attribute 'effort'"),
    (LocalJoy, "self is missing in configure: self.joy = ...", "no attribute 'joy'"),
    (OnlyTheCallbackSetsIt, "begin with an empty message, Latest(Joy())", "no attribute 'message'"),
    (Config, "config should be configure", "Config has no method configure"),
    (CallsTheCallback, "called at once: give it without parentheses, self.on_joy.", "configure: create_subscription"),
    (CallsTheCallbackWithNothing, "give it without parentheses, self.on_joy.", "configure raised TypeError"),
    (ClassForAnObject, "Latest alone is the class", "raised TypeError"),
    (ClassForAMessage, "Joy alone is the class", "initialize raised AttributeError"),
    (NotCalled, "parentheses are missing: get()", "before the first message"),
    (NoUnconfigure, "unconfigure is missing", "after unconfigure it still listens"),
    (EmptyUnconfigure, "self.node.destroy_subscription(self.subscription)", "after unconfigure it still listens"),
    (MisspelledUnconfigure, "unconfig should be unconfigure", "after unconfigure it still listens"),
    (NoControl, "Write the method control", "NoControl has no method control"),
]


@pytest.mark.parametrize(("answer", "cause", "text"), WRONG, ids=lambda value: getattr(value, "__name__", ""))
def test_a_wrong_answer_gets_its_own_sentence(domain, answer, cause, text):
    verdict = drive.judge(answer)
    assert not verdict.right
    assert cause in verdict.causes[0], str(verdict)
    assert text in next(finding.text for finding in verdict.findings if not finding.right)
    assert len(verdict.causes) == 1, "one mistake, one cause"


def test_the_solution_is_right(domain):
    verdict = drive.judge(GentleTank)
    assert verdict.right, str(verdict)
    assert str(verdict).endswith("no lock is to be seen.")


class DestroyedByItself(GentleTank):
    def unconfigure(self):
        self.subscription.destroy()


def test_a_subscription_that_is_destroyed_without_its_node_is_told_the_better_way(domain):
    verdict = drive.judge(DestroyedByItself)
    assert verdict.right, str(verdict)
    assert "Better call self.node.destroy_subscription(self.subscription)" in str(verdict)
    assert "Better call" not in str(drive.judge(GentleTank))


def test_two_mistakes_get_two_sentences(domain):
    causes = drive.judge(SwappedAndNoDeadZone).causes
    assert len(causes) == 2
    assert "left and right are exchanged" in causes[0]
    assert "dead zone is missing" in causes[1]


def test_one_dead_zone_and_a_speed_that_stays_are_two_mistakes(domain):
    causes = drive.judge(OneZoneAndKeepsRunning).causes
    assert len(causes) == 2
    assert any("share one dead zone" in cause for cause in causes)
    assert any("the last speed stays" in cause for cause in causes)


def test_without_self_the_method_is_shown(domain):
    assert "  in control, line " in str(drive.judge(ControlWithoutSelf))
    assert ": def control():" in str(drive.judge(ControlWithoutSelf))


class OwnLock(GentleTank):
    """Right, without a Latest: a lock of its own, and two numbers."""

    def configure(self, config):
        self.node = config.node
        self.lock = threading.Lock()
        self.x = self.y = 0.0
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message):
        axes = [*message.axes, 0.0, 0.0]
        with self.lock:
            self.x = dead(axes[0])
            self.y = dead(axes[1])

    def control(self):
        with self.lock:
            x, y = self.x, self.y
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


class WholeMessage(Formula):
    """Right, without a lock: one attribute, that is replaced as a whole."""

    def configure(self, config):
        self.node = config.node
        self.message = Joy()
        self.subscription = config.node.create_subscription(Joy, "/joy", self.on_joy, 10)

    def on_joy(self, message):
        self.message = message

    def control(self):
        axes = [*self.message.axes, 0.0, 0.0]
        self.track_l.ctrl, self.track_r.ctrl = self.speeds(axes)


@pytest.mark.parametrize("answer", [OwnLock, WholeMessage])
def test_other_right_answers_are_right(domain, answer):
    verdict = drive.judge(answer)
    assert verdict.right, str(verdict)


class Unreachable(GentleTank):
    def configure(self, config):
        self.node = config.node
        self.joy = Latest(Joy())
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, qos)


def test_a_subscription_that_nothing_reaches_is_not_waited_for(domain, monkeypatch):
    monkeypatch.setattr("tutorial.checks._node.PATIENCE", 0.3)
    verdict = drive.judge(Unreachable)
    assert "QoS" in str(verdict)


class PiecewiseInOneLine(Piecewise):
    def on_joy(self, message):
        axes = [*message.axes, 0.0, 0.0]
        self.x, self.y = dead(axes[0]), dead(axes[1])


class ReadPiecewise(ReadTwice):
    def control(self):
        x, y = dead(self.joy.get()[0]), dead(self.joy.get()[1])
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


@pytest.mark.parametrize("answer", [PiecewiseInOneLine, ReadPiecewise])
def test_a_race_within_one_line_is_found_too(domain, answer):
    assert "half of it is used" in str(drive.judge(answer))


class FailsBetweenTwoMessages(GentleTank):
    def configure(self, config):
        self.node = config.node
        self.messages = [Joy()]
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message):
        self.messages.clear()
        self.messages.append(message)

    def control(self):
        axes = [*self.messages[0].axes, 0.0, 0.0]
        x, y = dead(axes[0]), dead(axes[1])
        self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


def test_an_exception_that_only_a_race_brings_about_is_told(domain):
    said = str(drive.judge(FailsBetweenTwoMessages))
    assert "✗ a message that comes while control runs: control raised IndexError" in said
    assert "piece by piece" in said
    assert "in control, line" in said


class GivesTheNodeUp(GentleTank):
    def configure(self, config):
        super().configure(config)
        config.node.destroy_node()


def test_an_odd_answer_does_not_stop_the_check(domain, monkeypatch):
    monkeypatch.setattr("tutorial.checks._node.PATIENCE", 0.3)
    assert not drive.judge(GivesTheNodeUp).right
