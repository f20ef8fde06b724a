"""The exercise `publish`: publish joint states at a different rate.

Write the controller `SlowPublisher`. It publishes a `JointState` on its body's topic `turret`. For the body
`Tank`, the topic is `Tank/turret`, without a leading slash, so that it is in the node's namespace.

- It publishes 25 times per simulated second: one message every `round(1 / (25 * io.time_step))` steps. You may also
  publish at the steps nearest to the multiples of 1/25 s, so that the rate is exact on average. Publish the first
  message within 1/25 s of the start.
- It publishes even if nothing has changed.
- Each message lists all joints of the body in the order of `io.body.joints`, with position, velocity and effort.
- The stamp is the simulated time of publication.
- It works for any body and any time step up to 10 ms.
- If the simulation is stopped and restarted, `initialize` is called again, but `io.step` and `io.time_ns` don't restart
  at 0.
- In `unconfigure`, have the node destroy the publisher.

Hint 1: Where does each value come from? Get the topic from config.body.name, the joints from io.body.joints, the rate
from io.step and io.time_step, and the stamp from io.time_ns. You need no wall clock, and no hard-coded joint names.

Hint 2: Create the publisher in configure. In initialize, store io, and compute the number of steps from one message to
the next. In control, when a message is due, create it, fill each of its lists from the same joints, set its stamp and
publish it. In unconfigure, have the node destroy the publisher.

Hint 3: self.steps_per_message = round(1 / (25 * io.time_step)); if self.io.step % self.steps_per_message == 0;
message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg(); message.position = [joint.position for joint in
self.joints], and so on; self.node.destroy_publisher(self.publisher).

Notice that neither the rate nor the stamp depends on the wall clock: even if the simulation runs slowly, the messages
are the same.
"""

from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks.engine.cases import Case, Mistake, replace
from tutorial.checks.engine.observe import same
from tutorial.checks.engine.publishing import ALL_JOINTS, Publishing
from tutorial.checks.engine.rig import Rig, Sent
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController


class SlowPublisher(SimpleController):
    """Publish the position, velocity and effort of every joint at 25 Hz."""

    def configure(self, config: ControllerConfig) -> None:
        """Create the publisher on a topic named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(JointState, f"{config.body.name}/turret", 1)

    def initialize(self, io: ControllerIO) -> None:
        """Store the joints of the simulated body."""
        self.io = io
        self.joints = io.body.joints
        self.steps_per_message = round(1 / (25 * io.time_step))

    def control(self) -> None:
        """Publish when a message is due."""
        if self.io.step % self.steps_per_message == 0:
            message = JointState()
            message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
            message.name = [joint.name for joint in self.joints]
            message.position = [joint.position for joint in self.joints]
            message.velocity = [joint.velocity for joint in self.joints]
            message.effort = [joint.effort for joint in self.joints]
            self.publisher.publish(message)

    def unconfigure(self) -> None:
        """Destroy the publisher."""
        self.node.destroy_publisher(self.publisher)


MISTAKES = [
    Mistake(ALL_JOINTS, replace("io.body.joints", '[io.body.joint(name) for name in ("TURRET_Y", "TURRET_P")]',
                                "io.body.joints[:2]")),
    Mistake("your code changes the order of the joints. Keep the order of io.body.joints.",
            replace("io.body.joints", "sorted(io.body.joints, key=lambda joint: joint.name)", "io.body.joints[::-1]")),
]  # fmt: skip
MEANING = f"Most likely {ALL_JOINTS}"
UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}


def moving(trial: Trial, speed: int = 1, **options: Any) -> Rig:
    """Make a rig whose joints all move differently, so that all numbers differ; if ``speed`` is 0, they don't move."""

    def move() -> None:
        data = rig.body.data
        for values, scale in ((data.qpos, 0.00123), (data.qvel, 0.0123 * speed), (data.qfrc_actuator, -0.123)):
            values[:] = scale * (speed * rig.io.step + 1) * np.arange(1, len(values) + 1)

    rig = Rig(trial, move, **options)
    rig.displayed.set_joint_positions({name: 0.3 + 0.1 * i for i, name in enumerate(rig.body.joint_names)})
    move()
    return rig


def names(_rig: Rig, sent: list[Sent]) -> str:
    """Observe the names."""
    return "; ".join({", ".join(each.message.name) or "none": None for each in sent})


def numbers(_rig: Rig, sent: list[Sent], field: str) -> dict[str, list[Any]]:
    """Observe the numbers in a field, divided by the step number."""
    seen = [[number / (each.step + 1) for number in getattr(each.message, field)] for each in sent]
    text = ", ".join(f"{number:.4f}" for number in seen[-1]) or "no number"
    changed = [now for before, now in pairwise([[], *seen]) if not same(before, now)]
    return {f"{text} {UNITS[field]} per step": changed}


def at_rest(trial: Trial) -> Any:
    """Observe how often a message is sent while nothing moves."""
    return PUBLISHING.often(PUBLISHING.play(trial, 0.2, speed=0))


def joints(rig: Rig, sent: list[Sent]) -> list[Any]:
    """Observe the names and numbers."""
    return [names(rig, sent), *(numbers(rig, sent, field) for field in UNITS)]


PUBLISHING = Publishing(JointState, "turret", 25, moving, joints)
CASES = [
    Case("the names", PUBLISHING.sent(0.2, names), "Your code probably omits, repeats or renames joints. "
         "In each message, set name to [joint.name for joint in self.joints]."),
    Case("position", PUBLISHING.sent(0.2, partial(numbers, field="position")),
         "Your code probably omits position, rounds or converts it, mixes up the joints, or sends "
         "old values. Read the current values for each message: [joint.position for joint in self.joints]."),
    Case("velocity", PUBLISHING.sent(0.2, partial(numbers, field="velocity")),
         "Your code probably omits velocity or computes it, mixes up the joints, or sends old "
         "values. Read the current values for each message: [joint.velocity for joint in self.joints]."),
    Case("effort", PUBLISHING.sent(0.2, partial(numbers, field="effort")),
         "Your code probably omits effort, mixes up the joints, or sends old values. "
         "Read the current values for each message: [joint.effort for joint in self.joints]."),
    Case("while nothing moves", at_rest, "Your code probably publishes only changes. Publish "
         "every message, even if it repeats the previous one."),
    Case("on the crane Lift", PUBLISHING.sent(0.2, model="crane", name="Lift")),
]  # fmt: skip
publish = Exercise("publish", __doc__, PUBLISHING.cases(SlowPublisher, CASES, MISTAKES, MEANING))
