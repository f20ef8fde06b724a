"""Exercises of step 3: match joints by name, show what another program publishes, and keep up with it."""

from __future__ import annotations

from sensor_msgs.msg import JointState

from tutorial.checks._display import judge_show
from tutorial.checks._keep_up import judge_keep_up
from tutorial.checks.by_name import by_name
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, SimpleController
from tutorial.joints import match_joints

__all__ = ["by_name", "keep_up", "show"]


class MyViewer(SimpleController):
    """Show the joint states that another program publishes."""

    def configure(self, config: ControllerConfig) -> None:
        """Subscribe to the topic that is named after the body."""
        self.body = config.body
        self.node = config.node
        self.call_later = config.call_later
        topic = f"{self.body.name}/joint_state"
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1)

    def on_joint_state(self, message: JointState) -> None:
        """Hand the message to the main thread."""
        self.call_later(self.update, message)

    def update(self, message: JointState) -> None:
        """Move the body's joints to where the message says."""
        positions, report = match_joints(self.body.joint_names, message)
        self.body.set_joint_positions(positions)
        self.body.calc_forward_kinematics()
        self.body.notify_change(report)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


class CalmViewer(SimpleController):
    """Show the newest joint states that another program publishes."""

    def configure(self, config: ControllerConfig) -> None:
        """Subscribe to the topic that is named after the body."""
        self.body = config.body
        self.node = config.node
        self.call_latest = config.call_latest
        topic = f"{self.body.name}/joint_state"
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1)

    def on_joint_state(self, message: JointState) -> None:
        """Hand the message to the main thread, in the place of one that still waits there."""
        self.call_latest(self.body.name, self.update, message)

    def update(self, message: JointState) -> None:
        """Move the body's joints to where the message says."""
        positions, report = match_joints(self.body.joint_names, message)
        self.body.set_joint_positions(positions)
        self.body.calc_forward_kinematics()
        self.body.notify_change(report)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


show = Exercise(
    name="show",
    statement="""
    Write the controller `MyViewer`. It listens to the topic `joint_state` of its body, which for the body `Tank` is
    `/Tank/joint_state` (type `JointState`), and shows on the displayed body what it hears.

    - The displayed body belongs to the main thread: the callback only posts, with `config.call_later`.
    - What is posted matches by name (`match_joints`), sets the positions, computes the kinematics, and tells the
      observers.
    - It works on any body, and when it leaves the body it stops listening.
    """,
    judge=judge_show,
    solution=(MyViewer,),
    base=SimpleController,
    parts=("configure", "unconfigure"),
    requires=("configure",),
    hints=(
        "Look at the two threads: the callback runs on the executor's, and the displayed body belongs to the main "
        "thread. What moves it may only run there.",
        "In configure keep config.body and config.call_later, and subscribe to a topic made from the body's name. The "
        "callback has one line: it posts a method, with the message. That method matches, sets the positions, "
        "computes the kinematics and notifies, in this order.",
        "The callback: self.call_later(self.update, message), without parentheses after update. In update: positions, "
        "report = match_joints(self.body.joint_names, message), then set_joint_positions, calc_forward_kinematics "
        "and notify_change. In unconfigure: self.node.destroy_subscription(self.subscription).",
    ),
    notice="Notice that the body's name and its joints come from the body, so the crane needed no other line.",
)

keep_up = Exercise(
    name="keep_up",
    statement="""
    Write the controller `CalmViewer`, for messages that are whole states. It does what `MyViewer` does, but keeps up
    with any publisher: while the main thread is busy, at most one call waits for it, and what it shows then is the
    newest message. The last one before the publisher falls silent is always shown.
    """,
    judge=judge_keep_up,
    solution=(CalmViewer,),
    base=SimpleController,
    parts=("configure", "unconfigure"),
    requires=("configure",),
    hints=(
        "Look at what waits while the main thread is busy: with MyViewer a call for every message, although only the "
        "newest will be seen. What would have to happen to a call that still waits when the next message comes?",
        "ControllerConfig has two ways to post. One of them replaces a call that still waits, if both were posted "
        "under the same key: the key says what the call is about. All else stays as in MyViewer.",
        "In configure keep config.call_latest in place of config.call_later. It takes a key first, which has to be "
        "the same for every message and may be the body's name; then the function and the message, as before.",
    ),
    notice="Notice what is lost: a call that is replaced never runs, so every message has to name all joints.",
)
