"""The exercise `publish`: publish joint states at another rate.

Write the controller `SlowPublisher`. It publishes a `JointState` on the topic `turret` of its body, which for the
body `Tank` is `Tank/turret`, without a slash in front, so it is in the namespace of the node. It does so 25 times per
simulated second, as nearly as whole steps allow.

- Each message names all joints of the body, in the body's order, with position, velocity and effort.
- Its stamp is the simulated time at which it is sent.
- It works on any body, and with any time step.
- In `unconfigure`, when it leaves the body, the node destroys its publisher.

Hint 1: Look at what comes from where: the topic from config.body.name, the joints from io.body.joints, the rate from
io.step and io.time_step, the stamp from io.time_ns. Nothing comes from the wall clock, and you type no joint's name.

Hint 2: Make the publisher in configure. In initialize keep io, and compute how many steps there are from one message
to the next. In control, when it is time to, make a new message, fill one list for each field, all over the same
joints, stamp it and publish it. In unconfigure have the node destroy the publisher.

Hint 3: self.steps_per_message = round(1 / (25 * io.time_step)); if self.io.step % self.steps_per_message == 0;
message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg(); message.position = [joint.position for joint in
self.joints], and so on; self.node.destroy_publisher(self.publisher).

Notice that neither the rate nor the stamp uses the wall clock: a slow simulation publishes the same.
"""

from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.exercise import Exercise, Publishing, Rig, Sent, same
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController


class SlowPublisher(SimpleController):
    """Publish position, velocity and effort of every joint at 25 Hz."""

    def configure(self, config: ControllerConfig) -> None:
        """Announce the topic, named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(JointState, f"{config.body.name}/turret", 1)

    def initialize(self, io: ControllerIO) -> None:
        """Take the joints of the simulated body."""
        self.io = io
        self.joints = io.body.joints
        self.steps_per_message = round(1 / (25 * io.time_step))

    def control(self) -> None:
        """Publish, when it is time to."""
        if self.io.step % self.steps_per_message == 0:
            message = JointState()
            message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
            message.name = [joint.name for joint in self.joints]
            message.position = [joint.position for joint in self.joints]
            message.velocity = [joint.velocity for joint in self.joints]
            message.effort = [joint.effort for joint in self.joints]
            self.publisher.publish(message)

    def unconfigure(self) -> None:
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)


MISTAKES = """
the joints' names are typed, or how many there are: take all of them from the body, io.body.joints.
    io.body.joints => [io.body.joint(name) for name in ("TURRET_Y", "TURRET_P")] => io.body.joints[:2]

the message is filled once, in initialize, and sent again and again: fill it in control, every time.
    self.io = io => self.io, self.began_ns = io, io.time_ns
    self.io.time_ns => self.began_ns
    io.body.joints => [type("", (), {f: getattr(j, f) for f in ("name", *UNITS)}) for j in io.body.joints]

# the names
These are not all joints' names, once and in order: [joint.name for joint in self.joints], in a new message.

# position
position is missing, converted, mixed up or old: in control, every time, [joint.position for joint in self.joints].

# velocity
velocity is missing, mixed up or old: in control, every time, [joint.velocity for joint in self.joints].

# effort
effort is missing, mixed up or old: in control, every time, [joint.effort for joint in self.joints].
"""
UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}


def moving(answer: type, **options: Any) -> Rig:
    """Make a rig whose joints move, each differently, so that no two numbers are alike."""

    def move() -> None:
        data = rig.body.data
        for values, scale in ((data.qpos, 0.00123), (data.qvel, 0.0123), (data.qfrc_actuator, -0.123)):
            values[:] = scale * (rig.io.step + 1) * np.arange(1, len(values) + 1)

    rig = Rig(answer, move, **options)
    rig.displayed.set_joint_positions({name: 0.3 + 0.1 * i for i, name in enumerate(rig.body.joint_names)})
    move()
    return rig


def names(_rig: Rig, sent: list[Sent]) -> str:
    """Observe the names."""
    return "; ".join({", ".join(each.message.name) or "none": None for each in sent})


def numbers(_rig: Rig, sent: list[Sent], field: str) -> dict[str, list[Any]]:
    """Observe the numbers of a field, as they change from step to step."""
    seen = [[number / (each.step + 1) for number in getattr(each.message, field)] for each in sent]
    text = ", ".join(f"{number:.4f}" for number in seen[-1]) or "no number"
    changed = [now for before, now in pairwise([[], *seen]) if not same(before, now)]
    return {f"{text} {UNITS[field]} per step": changed}


def joints(rig: Rig, sent: list[Sent]) -> list[Any]:
    """Observe the names and numbers."""
    return [names(rig, sent), *(numbers(rig, sent, field) for field in UNITS)]


PUBLISHING = Publishing(JointState, "turret", 25, moving, joints)
TRIED = {
    "the names": PUBLISHING.sent(0.2, names),
    **{field: PUBLISHING.sent(0.2, partial(numbers, field=field)) for field in UNITS},
    "on the crane Lift": PUBLISHING.sent(0.2, model="crane", name="Lift"),
}
publish = Exercise("publish", __doc__, PUBLISHING.cases(SlowPublisher, TRIED, MISTAKES))
