"""The exercise `show`: right answers in various styles, and wrong ones."""

import asyncio
import threading
from collections import deque
from functools import partial

from sensor_msgs.msg import JointState

from tutorial.checks.joint_state_subscriber import MyViewer, show
from tutorial.controllers.joint_state_subscriber import JointStateSubscriber

from . import edited


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


RIGHT = [OnePerMessage, ByAPartial, ByTheLoop, JointStateSubscriber]


def changed(**methods):
    return type("Changed", (MyViewer,), methods)


def locked(method):
    return lambda self, message: (self.lock.acquire(), method(self, message), self.lock.release())


LOCKING = {"on_joint_state": locked(MyViewer.on_joint_state), "update": locked(MyViewer.update)}


def calls_the_callback(self, config):
    self.subscription = config.node.create_subscription(JointState, "joint_state", self.on_joint_state(None), 1)


def shares_its_body(self, config):
    MyViewer.configure(self, config)
    del self.body
    type(self).body = config.body


def subscribes_first(self, config):
    self.subscription = config.node.create_subscription(
        JointState, f"{config.body.name}/joint_state", self.on_joint_state, 1
    )
    self.body, self.node, self.call_later = config.body, config.node, config.call_later


WRONG = [
    (changed(configure=subscribes_first), "creates the subscription before the attributes that its callback uses"),
    (changed(on_joint_state=lambda self, message: self.update(message)), "moves the body in the callback"),
    (
        changed(on_joint_state=lambda self, m: self.call_later(self.update(m))),
        "calls the function immediately, with parentheses",
    ),
    (changed(on_joint_state=lambda self, m: threading.Thread(target=print).start()), "its own timer or thread"),
    (changed(configure=shares_its_body), "Changed.body is shared by all objects of the class"),
    (changed(lock=threading.Lock(), **LOCKING), "Don't sleep or wait"),
    (changed(configure=calls_the_callback, on_joint_state=print), "Pass it without parentheses"),
    (changed(on_joint_state=lambda self, m: self.call_later(self.on_joint_state, m)), "posts itself"),
]

POSITIONS, MATCHES = "positions(positions)", "positions, report ="
NO_ANTENNA = 'positions({n: q for n, q in zip(message.name, message.position) if n != "ANTENNA"})'
IF_NEWS = 'self.old, old = positions, vars(self).get("old")\nif positions != old: self.body.notify'
WRONG += [
    (edited(show, *edits), cause)
    for edits, cause in [
        ([(POSITIONS, "positions(dict(zip(self.body.joint_names, message.position)))")], "by their index"),
        ([(POSITIONS, "positions({n: q for n, q in positions.items() if q})")], "skips positions of 0"),
        ([(POSITIONS, "positions(dict(zip(message.name, message.position)))")], "a joint that the body does not have"),
        ([(POSITIONS, NO_ANTENNA)], "sets NaN as a position"),
        ([(MATCHES, f"[message.position[i] for i, _ in enumerate(message.name)]\n{MATCHES}")], "an index beyond"),
        ([(MATCHES, f"if message.header.stamp.sec < 1: return\n{MATCHES}")], "because of its stamp"),
        ([("self.body.notify", IF_NEWS)], "repeats the positions"),
        ([("config.call_later", "get_running_loop().call_soon_threadsafe")], "posts a call directly to the event loop"),
        ([("config.call_later", 'lambda *call: config.call_latest("joints", *call)')], "probably loses messages"),
    ]
]
