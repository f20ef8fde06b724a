"""Exercises of step 1: hear a button, read axes from anybody, hold a joint where the stick has put it, and drive."""

from __future__ import annotations

from math import isfinite

from sensor_msgs.msg import Joy

from tutorial.body import Joint
from tutorial.checks._aim import judge_aim
from tutorial.checks._bound import judge_bound
from tutorial.checks._drive import judge_drive
from tutorial.checks._fire import judge_fire
from tutorial.checks.exercise import Exercise
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.handoff import Latest

__all__ = ["aim", "bound", "drive", "fire"]


class Listener(SimpleController):
    """Listen to the joystick, as in the notebook."""

    def configure(self, config: ControllerConfig) -> None:
        """Listen to the joystick."""
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = self.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message: Joy) -> None:
        """Keep the newest state of the joystick."""
        self.joy.put(message)

    def unconfigure(self) -> None:
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


class FireButton(Listener):
    """Say whether the joystick's first button is pressed."""

    def __init__(self) -> None:
        self.fire = Latest(False)

    def on_joy(self, message: Joy) -> None:
        """Keep the newest state of the button."""
        pressed = len(message.buttons) > 0 and message.buttons[0] == 1
        self.fire.put(pressed)


def four_axes(message: Joy) -> list[float]:
    """Return the sticks' axes, each in [-1, 1]; one that the message lacks, or that is not finite, counts as 0."""
    axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4]
    return [min(max(axis, -1.0), 1.0) if isfinite(axis) else 0.0 for axis in axes]


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


class HeldJoint:
    """One joint that a stick moves, and that is held where the stick has put it."""

    def __init__(self, joint: Joint, time_step: float) -> None:
        self.joint = joint
        self.time_step = time_step
        self.q_ref = self.q_prev = joint.position

    def aim(self, stick: float) -> None:
        """Move the reference by the stick, and set the torque that follows it."""
        lower, upper = self.joint.range
        q_ref = min(max(self.q_ref + 0.002 * stick, lower), upper)
        dq_ref = (q_ref - self.q_ref) / self.time_step
        q = self.joint.position
        dq = (q - self.q_prev) / self.time_step
        self.joint.effort = 200 * (q_ref - q) + 50 * (dq_ref - dq)
        self.q_ref, self.q_prev = q_ref, q


fire = Exercise(
    name="fire",
    statement="""
    Write the callback `on_joy` of `FireButton`: it puts `True` into `self.fire` if button 0 of the message is pressed,
    else `False`. In `message.buttons` a button that is pressed is 1, else 0; one that the message lacks is not pressed.
    """,
    judge=judge_fire,
    solution=(FireButton,),
    base=SimpleController,
    parts=("on_joy",),
    hints=(
        "Look at what is put, and when: something at every message, also when the button is released, and when there "
        "are no buttons.",
        "message.buttons is a list, which may be empty: ask for its len before its first entry.",
        "pressed = len(message.buttons) > 0 and ..., and then self.fire.put(pressed).",
    ),
    notice="Notice that the callback only leaves a value behind, and returns.",
)

bound = Exercise(
    name="bound",
    statement="""
    Write the function `four_axes(message)`. It returns the first four axes of the `Joy` `message` as a list of four
    numbers from -1 to 1, whatever anybody has put into the message:

    - An axis beyond -1 or 1 is limited to that end.
    - One that is not finite, NaN or an infinity, counts as 0, and so does one that the message lacks.
    - Each axis stands for itself: the others count as if nothing was wrong with one.

    It is called a thousand times a second, so a million axes take no longer than four. It never raises, and leaves the
    message as it is.
    """,
    judge=judge_bound,
    solution=(four_axes,),
    base=None,
    parts=(),
    hints=(
        "Look at how much of the message is touched, however many axes there are; and at what a single axis may be: "
        "lacking, not finite, too large, too small.",
        "A slice takes at most four, and fewer where there are fewer: put zeros behind it, and take four of all. Then "
        "go through those: ask isfinite first, for NaN is neither smaller nor larger than a number, and limit the "
        "others with max and min.",
        "axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4], and then a list of min(max(axis, -1.0), 1.0) if "
        "isfinite(axis) else 0.0, for axis in axes.",
    ),
    notice="Notice that no message can make it fail or take long: whatever arrives is bounded before it is used.",
    imports=("from math import isfinite",),
)

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

aim = Exercise(
    name="aim",
    statement="""
    Write the method `aim` of `HeldJoint`. It is called once for every step of the simulation, with the stick's
    position between -1 and 1, and holds the joint where the stick has put it:

    - the reference angle begins where the joint stands, moves by 0.002 rad per call at full stick, and stays within
      `joint.range`;
    - the torque is `200 * (q_ref - q) + 50 * (dq_ref - dq)`, to be set as `joint.effort` [N.m]. `q` is
      `joint.position`, `q_ref` the reference after it has moved; `dq` and `dq_ref` are how fast the two have
      changed since the last call [rad/s]. A call is `time_step` seconds after the one before.
    """,
    judge=judge_aim,
    solution=(HeldJoint,),
    base=object,
    parts=("aim",),
    requires=("aim",),
    hints=(
        "Look at what has to outlive the call, and so belongs to self: there are two such numbers, and both begin "
        "where the joint stands. And at the ends of the range: joint.range has two.",
        "Move the reference first, and limit it. A speed is how far something has moved since the last call, divided "
        "by time_step: compute both speeds while the old values are still there. Keep the new ones at the very end.",
        "q_ref = min(max(self.q_ref + 0.002 * stick, lower), upper), then dq_ref = (q_ref - self.q_ref) / "
        "self.time_step; the same for q = self.joint.position and self.q_prev; then self.joint.effort = ..., and in "
        "the end self.q_ref, self.q_prev = q_ref, q.",
    ),
    notice="Notice that a reference which stays within the range answers at once when the stick is reversed.",
)
