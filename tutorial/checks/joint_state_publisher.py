"""Exercises of step 2: publish joint states, and publish only what is news."""

from __future__ import annotations

from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.checks._publish import judge_publish
from tutorial.checks._thrift import judge_thrift
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController

__all__ = ["publish", "thrift"]


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


class ThriftyPublisher(SimpleController):
    """Publish the positions of the joints that have moved."""

    def configure(self, config: ControllerConfig) -> None:
        """Announce the topic, named after the body."""
        self.node = config.node
        self.publisher = self.node.create_publisher(JointState, f"{config.body.name}/joint_state", 10)

    def initialize(self, io: ControllerIO) -> None:
        """Begin with nothing sent."""
        self.io = io
        self.sent: dict[str, float] = {}
        self.steps_per_look = round(1 / (50 * io.time_step))

    def control(self) -> None:
        """Look, when it is time to, what is news."""
        if self.io.step % self.steps_per_look:
            return
        positions = {joint.name: joint.position for joint in self.io.body.joints}
        news = {n: q for n, q in positions.items() if n not in self.sent or abs(q - self.sent[n]) > 0.001}
        if news:
            message = JointState(name=list(news), position=list(news.values()))
            message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg()
            self.publisher.publish(message)
            self.sent.update(news)

    def unconfigure(self) -> None:
        """Take the topic back."""
        self.node.destroy_publisher(self.publisher)


publish = Exercise(
    name="publish",
    statement="""
    Write the controller `SlowPublisher`. It publishes a `JointState` on the topic `turret` of its body, which for
    the body `Tank` is `/Tank/turret`, 25 times per simulated second, as nearly as whole steps allow.

    - Each message names all joints of the body, in the body's order, with position, velocity and effort.
    - Its stamp is the simulated time at which it is sent.
    - It works on any body, and with any time step.
    - When it leaves the body it destroys its publisher, in `unconfigure`.
    """,
    judge=judge_publish,
    solution=(SlowPublisher,),
    base=SimpleController,
    parts=("configure", "initialize", "control", "unconfigure"),
    requires=("configure", "initialize"),
    hints=(
        "Look at what comes from where: the topic from config.body.name, the joints from io.body.joints, the rate "
        "from io.step and io.time_step, the stamp from io.time_ns. Nothing comes from the wall clock, and no name is "
        "typed.",
        "Make the publisher in configure. In initialize keep io, and compute how many steps there are from one "
        "message to the next. In control, when it is time to, make a new message, fill one list for each field, all "
        "over the same joints, stamp it and publish it. Take the publisher back in unconfigure.",
        "self.steps_per_message = round(1 / (25 * io.time_step)); if self.io.step % self.steps_per_message == 0; "
        "message.header.stamp = Time(nanoseconds=self.io.time_ns).to_msg(); message.position = [joint.position for "
        "joint in self.joints], and so on; self.node.destroy_publisher(self.publisher).",
    ),
    notice="Notice that neither the rate nor the stamp asks for the wall clock: a slow simulation publishes the same.",
)

thrift = Exercise(
    name="thrift",
    statement="""
    Write the controller `ThriftyPublisher`. It publishes a `JointState` on the topic `joint_state` of its body, but
    only what is news:

    - 50 times per simulated second it looks which joints are more than 0.001 rad (or m) from the position that was
      last sent for them;
    - the message names these joints, with their positions; if there are none, nothing is sent;
    - the first message names all joints;
    - the stamp is the simulated time at which it is sent. Velocity and effort stay empty.
    - When it leaves the body it destroys its publisher, in `unconfigure`.
    """,
    judge=judge_thrift,
    solution=(ThriftyPublisher,),
    base=SimpleController,
    parts=("configure", "initialize", "control", "unconfigure"),
    requires=("configure", "initialize"),
    hints=(
        "Look at what is compared with what: each joint's position with the one that was last sent for this joint, "
        "which may have been long ago. Not with that of the last look, and not all joints together.",
        "Keep a dict from each joint's name to the position that was last sent for it. It is empty in the beginning, "
        "so all joints are news. Look every so many steps; collect what is news; only if there is any, send it, and "
        "only then note down what was sent.",
        "news = {name: q for name, q in positions.items() if name not in self.sent or abs(q - self.sent[name]) > "
        "0.001}. If it is not empty: message.name = list(news), message.position = list(news.values()), publish, then "
        "self.sent.update(news). In unconfigure: self.node.destroy_publisher(self.publisher).",
    ),
    notice="Notice that these messages are read by name: the viewer of step 3 shows them without a change.",
)
