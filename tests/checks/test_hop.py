"""The exercise `hop`: every wrong answer is told its cause."""

from __future__ import annotations

import asyncio
import threading
import time
from math import hypot

import pytest
from sensor_msgs.msg import Imu

from tutorial.checks.imu_subscriber import HopViewer, hop
from tutorial.controller import SimpleController


class Base(SimpleController):
    """A right answer, cut so that each wrong one changes a line or two."""

    height = 0.1
    seconds = 0.5

    def configure(self, config):
        self.body = config.body
        self.node = config.node
        self.call_later = config.call_later
        self.timer = None
        self.subscription = self.node.create_subscription(Imu, self.topic(), self.on_imu, 10)

    def topic(self):
        return f"{self.body.name}/imu"

    def on_imu(self, message):
        self.call_later(self.update, message)

    def update(self, message):
        a = message.linear_acceleration
        if self.is_blow(a.x, a.y, a.z):
            self.blow()

    def is_blow(self, x, y, z):
        return hypot(x, y) > 20

    def blow(self):
        if self.timer is None:
            self.note()
            self.lift()
        else:
            self.timer.cancel()
        self.start()

    def note(self):
        self.place = self.body.position

    def lift(self):
        x, y, z = self.place
        self.move((x, y, z + self.height))

    def start(self):
        self.timer = asyncio.get_running_loop().call_later(self.seconds, self.land)

    def land(self):
        if self.timer is not None:
            self.timer.cancel()
            self.timer = None
            self.go_back()

    def go_back(self):
        self.move(self.place)

    def move(self, position):
        self.body.position = position
        self.body.calc_forward_kinematics()
        self.body.notify_change()

    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        self.land()


class Task(Base):
    """A task that sleeps is as good as a timer."""

    def start(self):
        self.timer = asyncio.create_task(self.wait())

    async def wait(self):
        await asyncio.sleep(0.5)
        self.timer = None
        self.move(self.place)


class Ticking(Base):
    """Looks every 20 ms whether it is time."""

    def blow(self):
        self.ends_at = asyncio.get_running_loop().time() + 0.5
        if self.timer is None:
            self.note()
            self.lift()
            self.tick()

    def tick(self):
        if asyncio.get_running_loop().time() >= self.ends_at:
            self.land()
        else:
            self.timer = asyncio.get_running_loop().call_later(0.02, self.tick)


class Deadline(Base):
    def start(self):
        loop = asyncio.get_running_loop()
        self.timer = loop.call_at(loop.time() + 0.5, self.land)


class InCallback(Base):
    def on_imu(self, message):
        self.update(message)


class NeverPosts(Base):
    def on_imu(self, message):
        self.message = message


class RclpyTimer(Base):
    def start(self):
        self.timer = self.node.create_timer(0.5, self.land)


class ThreadTimer(Base):
    def start(self):
        self.timer = threading.Timer(600.0, self.land)  # so late that it does not trouble the other tests
        self.timer.daemon = True
        self.timer.start()


class Sleeps(Base):
    def start(self):
        time.sleep(0.5)


class NotUp(Base):
    def lift(self):
        self.body.notify_change()


class Sinks(Base):
    height = -0.1


class TooHigh(Base):
    height = 1.0


class Sideways(Base):
    def lift(self):
        self.move(self.place + 0.1)


class NoKinematics(Base):
    def move(self, position):
        self.body.position = position
        self.body.notify_change()


class NobodyTold(Base):
    def move(self, position):
        self.body.position = position
        self.body.calc_forward_kinematics()


class ToldEarly(Base):
    def move(self, position):
        self.body.notify_change()
        self.body.position = position
        self.body.calc_forward_kinematics()


class StaysUp(Base):
    def start(self):
        pass


class CalledAtOnce(Base):
    def blow(self):
        self.note()
        self.lift()
        self.timer = object()
        asyncio.get_running_loop().call_later(0.5, self.land())

    def land(self):
        self.timer = None
        self.move(self.place)


class TooSoon(Base):
    seconds = 0.05


class Milliseconds(Base):
    seconds = 5


class TakesOff(Base):
    def go_back(self):
        self.move(self.body.position - [0, 0, 0.1])


class NotedInConfigure(Base):
    def configure(self, config):
        super().configure(config)
        self.place = self.body.position

    def note(self):
        pass


class TypedPlace(Base):
    def go_back(self):
        self.move([0.0, 0.0, 0.105])


class OnlyX(Base):
    def is_blow(self, x, y, z):
        return abs(x) > 20


class Signed(Base):
    def is_blow(self, x, y, z):
        return x > 20 or y > 20


class WithZ(Base):
    def is_blow(self, x, y, z):
        return hypot(x, y, z) > 20


class Sum(Base):
    def is_blow(self, x, y, z):
        return abs(x) + abs(y) > 20


class NoRoot(Base):
    def is_blow(self, x, y, z):
        return x * x + y * y > 20


class Either(Base):
    def is_blow(self, x, y, z):
        return abs(x) > 20 or abs(y) > 20


class Everything(Base):
    def is_blow(self, x, y, z):
        return True


class OtherLimit(Base):
    def is_blow(self, x, y, z):
        return hypot(x, y) > 16


class NotMore(Base):
    def is_blow(self, x, y, z):
        return hypot(x, y) >= 20


class Higher(Base):
    def blow(self):
        if self.timer is not None:
            self.timer.cancel()
        self.note()
        self.lift()
        self.start()


class NotCancelled(Base):
    def blow(self):
        if self.timer is None:
            self.note()
            self.lift()
        self.start()

    def land(self):
        if self.timer is not None:
            self.timer = None
            self.go_back()


class Ignored(Base):
    def blow(self):
        if self.timer is None:
            super().blow()


class TimerLeft(Base):
    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)


class UpForEver(Base):
    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        if self.timer is not None:
            self.timer.cancel()


class ToldNothingAtTheEnd(Base):
    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        if self.timer is not None:
            self.timer.cancel()
            self.body.position = self.place
            self.body.calc_forward_kinematics()


class AlwaysBack(Base):
    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)
        if self.timer is not None:
            self.timer.cancel()
        self.go_back()


class BackToNowhere(AlwaysBack):
    place = (0.0, 0.0, 0.0)


class StillListens(Base):
    def unconfigure(self):
        self.land()


class TypedTopic(Base):
    def topic(self):
        return "Tank/imu"


class Shared(Base):
    timers = [None]

    def configure(self, config):
        super().configure(config)
        del self.timer

    def __getattr__(self, name):
        if name == "timer":
            return type(self).timers[0]
        raise AttributeError(name)

    def __setattr__(self, name, value):
        if name == "timer":
            type(self).timers[0] = value
        else:
            super().__setattr__(name, value)

    def __delattr__(self, name):
        pass


@pytest.mark.parametrize("answer", [HopViewer, Base, Task, Ticking, Deadline])
def test_right_answers_are_right(answer, domain):
    verdict = hop.judge(answer)
    assert verdict.right, str(verdict)


@pytest.mark.parametrize(
    ("answer", "cause"),
    [
        (InCallback, "the callback moves the body itself"),
        (NeverPosts, "the callback posts nothing"),
        (RclpyTimer, "rclpy's timers call on the executor's thread"),
        (ThreadTimer, "nor may threading.Timer"),
        (Sleeps, "Leave out what sleeps"),
        (NotUp, "the body is not moved"),
        (Sinks, "the sign is turned round"),
        (TooHigh, "Compare with 0.1 m"),
        (Sideways, "z points up"),
        (NoKinematics, "self.body.calc_forward_kinematics() is missing"),
        (NobodyTold, "self.body.notify_change() is missing"),
        (ToldEarly, "or comes too early"),
        (StaysUp, "nothing is to bring it back"),
        (CalledAtOnce, "the parentheses call the function at once"),
        (TooSoon, "seconds are too few"),
        (Milliseconds, "seconds are too many"),
        (TakesOff, "0.1 is taken off again"),
        (NotedInConfigure, "noted too early"),
        (TypedPlace, "the place is typed"),
        (OnlyX, "only x counts"),
        (Signed, "hypot(x, y) has no sign"),
        (WithZ, "z counts, too"),
        (Sum, "the components are added up"),
        (NoRoot, "the root is missing"),
        (Either, "the larger component alone counts"),
        (Everything, "every message counts as a blow"),
        (OtherLimit, "Compare with hypot(a.x, a.y) > 20"),
        (NotMore, "is not more than 20"),
        (Higher, "noted anew by a blow"),
        (NotCancelled, "the first blow's timer goes on"),
        (Ignored, "while the body is up is ignored"),
        (TimerLeft, "does not cancel the timer"),
        (UpForEver, "does not put the body back"),
        (ToldNothingAtTheEnd, "notify_change() is missing"),
        (AlwaysBack, "a place that was never noted"),
        (BackToNowhere, "a place that was never noted"),
        (StillListens, "destroy_subscription"),
        (TypedTopic, "take it from config.body"),
        (Shared, "shared by all objects of the class"),
    ],
)
def test_a_wrong_answer_is_told_its_cause(answer, cause, domain):
    verdict = hop.judge(answer)
    assert not verdict.right
    assert cause in "\n".join(verdict.causes), str(verdict)
