"""The exercise `drive`: right answers in various styles, and wrong ones."""

import threading
import time

import numpy as np
from sensor_msgs.msg import JointState, Joy

from tutorial.checks.bound import four_axes
from tutorial.checks.drive import GentleTank
from tutorial.handoff import Latest


def dead(axes):
    return [axis if abs(axis) > 0.3 else 0.0 for axis in list(axes)[:2]]


class OwnLock(GentleTank):
    """Keep two numbers under a lock, and the actuators in a dict."""

    def configure(self, config):
        self.node, self.lock, self.x, self.y = config.node, threading.Lock(), 0.0, 0.0
        self.subscription = self.node.create_subscription(Joy, "joy", self.on_joy, qos_profile=10)

    def on_joy(self, message):
        x, y = dead(four_axes(message))
        with self.lock:
            self.x = x
            self.y = y

    def initialize(self, io):
        self.motors = {side: io.body.actuator(f"TRACK_{side}") for side in "LR"}

    def control(self):
        with self.lock:
            x, y = self.x, self.y
        self.motors["L"].ctrl, self.motors["R"].ctrl = np.array([[-0.5, 1.0], [0.5, 1.0]]) @ (x, y)


class WholeMessage(GentleTank):
    """Keep one attribute, replaced as a whole, and log each change."""

    joy = None

    def configure(self, config):
        self.node = config.node
        self.subscription = self.node.create_subscription(Joy, "joy", lambda message: setattr(self, "joy", message), 1)

    def control(self):
        joy, self.seen = self.joy, time.monotonic()
        x, y = dead(four_axes(joy) if joy else [0, 0])
        self.track_l.ctrl, self.track_r.ctrl = y - x / 2, y + x / 2


RIGHT = [GentleTank, OwnLock, WholeMessage]


def in_callback(self, message):
    if hasattr(self, "track_l"):
        self.set(*dead(four_axes(message)))


def piecewise(self, message):
    self.x, self.y = dead(four_axes(message))


def read_twice(self):
    for track, turn in ((self.track_l, -0.5), (self.track_r, 0.5)):
        x, y = dead(four_axes(self.joy.get()))[:2]
        track.ctrl = y + turn * x


def smooth(self):
    axes = dead(four_axes(self.joy.get()))
    self.x, self.y = (0.9 * before + 0.1 * axis for before, axis in zip((self.x, self.y), axes))
    self.set(self.x, self.y)


def throttle(self, message):
    if time.monotonic() - getattr(self, "last", 0.0) > 0.05:
        self.last = time.monotonic()
        self.joy.put(message)


def no_lock(self, config):
    self.node, self.x, self.y = config.node, 0.0, 0.0
    self.subscription = self.node.create_subscription(Joy, "joy", self.on_joy, 1)


def subscribes_first(self, config):
    self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, 1)
    self.node, self.joy = config.node, Latest(Joy())


def other_type(self, config):
    self.node = config.node
    self.subscription = self.node.create_subscription(JointState, "joy", self.on_joy, 1)


def set_tracks(self, x, y):
    self.track_l.ctrl, self.track_r.ctrl = y - 0.5 * x, y + 0.5 * x


METHODS = [
    ({"on_joy": in_callback, "control": lambda self: self.joy.get()}, "callback probably sets the track speeds"),
    ({"configure": no_lock, "on_joy": piecewise, "control": lambda self: self.set(self.x, self.y)}, "one by one"),
    ({"control": read_twice}, "reads self.joy twice"),
    ({"control": lambda self: self.set(*dead(self.joy.get().axes[i] for i in (0, 1)))}, "assumes that a message"),
    ({"x": 0.0, "y": 0.0, "control": smooth}, "smooths the speeds"),
    ({"on_joy": throttle}, "arrive too close together"),
    ({"on_joy": lambda self, message: not any(message.axes) or self.joy.put(message)}, ["so the tank keeps moving"]),
    ({"configure": subscribes_first}, "creates the subscription before the attributes that its callback uses"),
    ({"configure": other_type}, ["a different topic or type", "reads it before it is set"]),
    ({"unconfigure": lambda self: self.subscription.destroy()}, "does not notify the node"),
    ({"unconfigure": lambda self: self.node.destroy_node()}, "In unconfigure, destroy only the subscription"),
]
WRONG = [(type("Answer", (GentleTank,), {"set": set_tracks, **methods}), cause) for methods, cause in METHODS]
