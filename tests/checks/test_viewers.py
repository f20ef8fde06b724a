"""The exercises `show` and `keep_up`: right answers in their styles, and what no edit of the solution tells."""

from __future__ import annotations

import asyncio
import threading
import time
from collections import deque
from functools import partial

import pytest
from sensor_msgs.msg import JointState

from tutorial.checks.joint_state_subscriber import CalmViewer, MyViewer, keep_up, show
from tutorial.controllers.joint_state_subscriber import JointStateSubscriber


class OnePerMessage(MyViewer):
    def on_joint_state(self, message):
        self.__dict__.setdefault("inbox", deque()).append(message)
        self.call_later(self.draw)

    def draw(self):
        self.update(self.inbox.popleft())


class ByAPartial(MyViewer):
    def configure(self, config):
        self.body, self.node = config.body, config.node
        post = partial(config.call_later, self.update)
        self.subscription = self.node.create_subscription(JointState, f"/{self.body.name}/joint_state", post, 1)


class ByTheLoop(MyViewer):
    def configure(self, config):
        self.loop, self.gone = asyncio.get_running_loop(), False
        super().configure(config)

    def on_joint_state(self, message):
        self.loop.call_soon_threadsafe(self.draw, message)

    def draw(self, message):
        if not self.gone:
            self.update(message)

    def unconfigure(self):
        self.gone = True
        super().unconfigure()


class WithAnAttribute(CalmViewer):
    def on_joint_state(self, message):
        self.message = message
        self.call_latest("joints", self.draw)

    def draw(self):
        self.update(self.message)


class TakesUnderALock(CalmViewer):
    def configure(self, config):
        self.lock, self.newest, self.call_later = threading.Lock(), None, config.call_later
        super().configure(config)

    def on_joint_state(self, message):
        with self.lock:
            first, self.newest = self.newest is None, message
        if first:
            self.call_later(self.draw)

    def draw(self):
        with self.lock:
            message, self.newest = self.newest, None
        self.update(message)


RIGHT = [
    *((show, answer) for answer in (OnePerMessage, ByAPartial, ByTheLoop, JointStateSubscriber)),
    *((keep_up, answer) for answer in (WithAnAttribute, TakesUnderALock)),
]


@pytest.mark.parametrize(("exercise", "answer"), RIGHT, ids=lambda value: getattr(value, "__name__", ""))
def test_right_answers_are_right(exercise, answer, domain):
    verdict = exercise.judge(answer)
    assert verdict.right, str(verdict)


def changed(base, **methods):
    return type("Changed", (base,), {name.strip("_"): method for name, method in methods.items()})


def waits(self, message):
    done = threading.Event()
    self.call_later(lambda: (self.update(message), done.set()))
    done.wait()


def in_the_wrong_order(self, message):
    self.body.calc_forward_kinematics()
    self.body.set_joint_positions(dict(zip(message.name, message.position)))
    self.body.notify_change()


def at_most_a_million_per_second(self, message):
    if time.perf_counter() - getattr(self, "last", 0.0) > 1e-6:
        self.last = time.perf_counter()
        CalmViewer.on_joint_state(self, message)


def newest_of_the_class(self, message):
    type(self).newest = message
    self.call_latest(0, lambda: self.update(type(self).newest))


def calls_the_callback(self, config):
    self.subscription = config.node.create_subscription(JointState, "joint_state", self.on_joint_state(None), 1)


WRONG = [
    (show, changed(MyViewer, on_joint_state=waits), "Leave out what sleeps or waits"),
    (show, changed(MyViewer, update=in_the_wrong_order), "calc_forward_kinematics() is called before set_joint"),
    (show, changed(MyViewer, update=lambda message: None), "self is missing"),
    (show, changed(MyViewer, on_joint_state=lambda message: None), "self is missing"),
    (show, changed(MyViewer, configure=calls_the_callback, on_joint_state=print), "give it without parentheses"),
    (show, changed(MyViewer, on_joint_state=lambda self, _: self.call_later(self.update)), "gets too few arguments"),
    (show, changed(MyViewer, on_joint_state=lambda self, m: self.call_later(self.on_joint_state, m)), "posts itself"),
    (
        show,
        changed(MyViewer, unconfigure=lambda self: self.node.destroy_subscription(self)),
        "not given what configure",
    ),
    (
        keep_up,
        changed(CalmViewer, on_joint_state=lambda self, m: self.call_latest(self.update, m)),
        "takes a key first",
    ),
    (keep_up, changed(CalmViewer, on_joint_state=at_most_a_million_per_second), "dropped by time or by count"),
    (keep_up, changed(CalmViewer, on_joint_state=newest_of_the_class), "Changed.newest is shared by all objects"),
]


@pytest.mark.parametrize(
    ("exercise", "answer", "cause"), WRONG, ids=lambda value: value if isinstance(value, str) else ""
)
def test_what_no_edit_tells_has_a_cause_too(exercise, answer, cause, domain):
    verdict = exercise.judge(answer)
    assert cause in verdict.causes[0], str(verdict)
