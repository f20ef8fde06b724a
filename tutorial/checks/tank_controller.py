"""Exercises of step 1: hear a button, read axes from anybody, hold a joint where the stick has put it, and drive."""

from __future__ import annotations

from sensor_msgs.msg import Joy

from tutorial.checks._drive import judge_drive
from tutorial.checks.aim import aim
from tutorial.checks.bound import bound, four_axes
from tutorial.checks.exercise import Exercise
from tutorial.checks.fire import fire
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.handoff import Latest

__all__ = ["aim", "bound", "drive", "fire"]


class GentleTank(SimpleController):
    """Drive the tracks with the left stick, gently."""

    def configure(self, config: ControllerConfig) -> None:
        """Listen to the joystick."""
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = self.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message: Joy) -> None:
        """Keep the newest state of the joystick."""
        self.joy.put(message)

    def initialize(self, io: ControllerIO) -> None:
        """Look up the tracks of the simulated tank."""
        self.track_l = io.body.actuator("TRACK_L")
        self.track_r = io.body.actuator("TRACK_R")

    def control(self) -> None:
        """Turn the stick into track speeds [m/s]."""
        axes = four_axes(self.joy.get())
        left_x, left_y = (axis if abs(axis) > 0.3 else 0.0 for axis in axes[:2])
        self.track_l.ctrl = 1.0 * left_y - 0.5 * left_x
        self.track_r.ctrl = 1.0 * left_y + 0.5 * left_x

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


drive = Exercise(
    name="drive",
    statement="""
    Write the controller `GentleTank`. It listens to the topic `joy` (type `Joy`) and drives only the tracks,
    the actuators `TRACK_L` and `TRACK_R`, from the left stick: `axes[0]` is `left_x`, positive to the left, and
    `axes[1]` is `left_y`, positive ahead.

    - The left track runs at `1.0 * left_y - 0.5 * left_x` [m/s], the right one at `1.0 * left_y + 0.5 * left_x`.
    - An axis within 0.3 of the middle counts as 0; each axis for itself.
    - An axis that the message lacks counts as 0, and so does everything before the first message.
    - When it leaves the body it stops listening: `unconfigure` undoes what `configure` did.

    Mind the threads: the callback runs on the executor's, `control` on the simulation's.
    """,
    judge=judge_drive,
    solution=(GentleTank,),
    base=SimpleController,
    parts=("configure", "initialize", "control", "unconfigure"),
    requires=("configure", "initialize"),
    hints=(
        "Look at the two threads: the callback runs on the executor's, control on the simulation's. And at what is "
        "true before the first message, and when one is shorter than you expect.",
        "Let the callback put the message into a Latest, which configure makes with an empty Joy(). Let control take "
        "it from there once in every step, read it with four_axes, apply the dead zone to each axis, and set both "
        "tracks every time.",
        "In configure: self.node = config.node and self.joy = Latest(Joy()). In control: axes = "
        "four_axes(self.joy.get()); then left_x, left_y = (axis if abs(axis) > 0.3 else 0.0 for axis in axes[:2]); "
        "then self.track_l.ctrl and self.track_r.ctrl. In unconfigure: "
        "self.node.destroy_subscription(self.subscription).",
    ),
    notice="Notice that control takes the message once and reads both axes from it, and that no lock is to be seen.",
)
