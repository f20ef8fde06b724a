"""The exercise `fire`: right answers in various styles, and wrong ones."""

import time

import numpy as np
from sensor_msgs.msg import Joy

from tutorial.checks.fire import FireButton
from tutorial.handoff import Latest


def put_what_changes(self, message):
    pressed = bool(message.buttons) and message.buttons[0] == 1
    if pressed != self.fire.get():
        self.node.get_logger().info(f"fire: {pressed}")
        self.fire.put(pressed)


def listen_alone(self, config):
    self.node = config.node
    self.subscription = self.node.create_subscription(Joy, "/joy", self.on_joy, qos_profile=10)


def put_if_pressed(self, message):
    if message.buttons[0] == 1:
        self.fire.put(True)


def assign(self, message):
    self.fire = Latest(bool(message.buttons) and message.buttons[0] == 1)


def debounce(self, message):
    if time.monotonic() - getattr(self, "changed", 0.0) > 0.05:
        self.changed = time.monotonic()
        self.fire.put(bool(message.buttons) and message.buttons[0] == 1)


METHODS = [
    ({"on_joy": lambda self, message: self.fire.put(sum(message.buttons[:1]))}, []),
    ({"on_joy": lambda self, message: self.fire.put(np.bool_(1 in np.array(message.buttons)[:1]))}, []),
    ({"on_joy": put_what_changes, "configure": listen_alone}, []),
    ({"on_joy": lambda self, message: self.fire.put(message.buttons[0])}, ["without checking that it exists"]),
    ({"on_joy": put_if_pressed}, ["doesn't put False into self.fire when the button is released"]),
    ({"on_joy": assign}, ["Your code probably assigns to self.fire"]),
    ({"on_joy": lambda self, message: self.fire.put(message.buttons and message.buttons[0])}, ["bool(...)"]),
    ({"configure": lambda self, config: setattr(self, "node", config.node)}, ["super().configure"]),
    ({"on_joy": debounce}, ["computer's clock, probably to ignore messages"]),
]
MADE = [(type("Answer", (FireButton,), methods), causes) for methods, causes in METHODS]
RIGHT = [answer for answer, causes in MADE if not causes]
WRONG = [(answer, causes) for answer, causes in MADE if causes]
