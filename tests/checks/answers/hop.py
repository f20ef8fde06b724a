"""The exercise `hop`: right answers in various styles, and wrong ones."""

import asyncio
import time

import numpy as np
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Imu

from tutorial.checks.hop import HopViewer, hop

from . import edited


class Task(HopViewer):
    """Use a sleeping task instead of a timer, and show the sensors' values, too."""

    def update(self, message):
        self.body.notify_change()
        a = message.linear_acceleration
        if a.x**2 + a.y**2 > 400:
            self.land()
            self.place = self.body.position
            self.move(np.add(self.place, (0, 0, 0.1)))
            self.timer = asyncio.create_task(self.wait())

    async def wait(self):
        await asyncio.sleep(0.5)
        self.timer = None
        self.move(self.place)


class Ticking(HopViewer):
    """Check the computer's clock every 20 ms."""

    def update(self, message):
        a = message.linear_acceleration
        if (a.x, a.y) != (0, 0) and abs(complex(a.x, a.y)) > 20:
            self.ends_at = time.monotonic() + 0.5
            if self.timer is None:
                self.place = self.body.position
                self.move(np.add(self.place, [0, 0, 0.1]))
                self.tick()

    def tick(self):
        if time.monotonic() >= self.ends_at:
            self.land()
        else:
            self.timer = asyncio.get_running_loop().call_later(0.02, self.tick)


class LikeASensor(HopViewer):
    """Use a QoS profile instead of a number, and a topic with a leading slash."""

    def configure(self, config):
        super().configure(config)
        self.node.destroy_subscription(self.subscription)
        topic = f"/{self.body.name}/imu"
        self.subscription = self.node.create_subscription(Imu, topic, self.on_imu, qos_profile_sensor_data)


class Remembers(HopViewer):
    """Keep an unused object on the class."""

    seen: list = []

    def update(self, message):
        self.seen.append(self.land)
        super().update(message)


RIGHT = [Task, Ticking, LikeASensor, Remembers]


def changed(**methods):
    return type("Changed", (HopViewer,), methods)


async def never_awaited(self, message):
    HopViewer.update(self, message)


async def fails(self):
    raise LookupError


def keeps_four(self, config):
    HopViewer.configure(self, config)
    self.node.destroy_subscription(self.subscription)
    self.subscription = self.node.create_subscription(Imu, f"{self.body.name}/imu", self.on_imu, 4)


def posts_after_seconds(self, message):
    self.call_later(0.5, self.land)


WRONG = [
    (changed(configure=keeps_four), "a queue depth of 10"),
    (changed(land=lambda self: time.monotonic()), "does not put the body back"),
    (changed(update=posts_after_seconds), "config.call_later has no delay"),
    (changed(update=never_awaited), "Write def, not async def"),
    (changed(update=lambda self, _: asyncio.get_running_loop().call_later(0.5, self.land())), "with parentheses"),
    (
        changed(update=lambda self, _: setattr(self, "timer", asyncio.create_task(fails(self)))),
        "raises this error itself",
    ),
    (changed(__setattr__=lambda self, *each: setattr(type(self), *each)), "is shared by all objects of the class"),
    (changed(on_imu=lambda self, m: asyncio.get_running_loop().call_soon(self.update, m)), "outside the main"),
]

POST, DESTROY = "self.call_later(self.update, message)", "self.node.destroy"
SKIP_EQUAL = "if message == vars(self).get('last'): return\nself.last = message\n"
PUT_BACK = f"self.timer.cancel()\nself.timer, self.body.position = None, self.place\n{DESTROY}"
WRONG += [
    (edited(hop, edit), cause)
    for edit, cause in [
        (("hypot(a.x, a.y)", "max(a.x, a.y)"), "Your code probably tests the wrong condition"),
        (("self.move(self.place)", "self.move(self.body.position - (0, 0, 0.1))"), "hard-codes the landing position"),
        (("> 20", "> 20 and not hasattr(self, 'place')"), "Set self.timer = None when the body lands"),
        ((POST, SKIP_EQUAL + POST), "is identical to the previous one"),
        (("a = message.", "if self.timer: self.timer.cancel()\na = message."), "reacts to a harmless message"),
        (("config.call_later", "lambda *call: config.call_latest('imu', *call)"), "Your code probably loses messages"),
        ((DESTROY, PUT_BACK), "puts the body back without"),
        ((DESTROY, f"self.move(getattr(self, 'place', (0.0, 0.0, 0.0)))\n{DESTROY}"), "even if it is not up"),
        ((DESTROY, f"if hasattr(self, 'place'): self.move(self.place)\n{DESTROY}"), "even if it is not up"),
        (("config.call_later", "asyncio.get_running_loop().call_soon_threadsafe"), "directly to the event loop"),
    ]
]
