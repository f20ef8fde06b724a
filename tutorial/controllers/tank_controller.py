"""Step 1: drive the tank with the joystick."""

from math import isfinite

from rclpy.node import Node
from sensor_msgs.msg import Joy

from tutorial.body import Joint
from tutorial.controller import ControllerConfig, ControllerIO, SimpleController
from tutorial.handoff import Latest

STEP_AT_FULL_STICK = 0.002  # [rad] change in a reference angle per simulation step
P_GAIN = 200.0  # [N.m/rad]
D_GAIN = 50.0  # [N.m.s/rad]


class TankController(SimpleController):
    """Drive the tracks with the left stick, and aim the turret and its barrel with the right stick."""

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Listen to the joystick."""
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = self.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message: Joy) -> None:  # executor's thread: put and return
        """Keep the newest state of the joystick."""
        self.joy.put(message)
        complain(self.node, message)

    def initialize(self, io: ControllerIO) -> None:  # simulation thread, before the first step
        """Look up the tracks and the joints of the simulated tank."""
        self.track_l = io.body.actuator("TRACK_L")
        self.track_r = io.body.actuator("TRACK_R")
        self.turret = AimedJoint(io.body.joint("TURRET_Y"), io.time_step)
        self.barrel = AimedJoint(io.body.joint("TURRET_P"), io.time_step)

    def control(self) -> None:  # simulation thread, every step
        """Convert stick positions to track speeds [m/s] and joint torques [N.m]."""
        left_x, left_y, right_x, right_y = sticks(self.joy.get())

        # full stick forward is 2 m/s; full stick sideways makes one track 1 m/s slower and the other 1 m/s faster
        self.track_l.ctrl = 2.0 * left_y - left_x
        self.track_r.ctrl = 2.0 * left_y + left_x

        self.turret.aim(-right_x)  # the turret's axis points down, so a positive angle turns it to the right
        self.barrel.aim(right_y)

    def unconfigure(self) -> None:  # main thread
        """Stop listening."""
        self.node.destroy_subscription(self.subscription)


class AimedJoint:
    """A joint that a stick aims: the stick moves a reference angle, and PD control makes the joint follow it."""

    def __init__(self, joint: Joint, time_step: float) -> None:
        self.joint = joint
        self.time_step = time_step
        self.q_ref = self.q_prev = joint.position

    def aim(self, stick: float) -> None:
        """Move the reference angle with the stick, within the joint's range, and set the torque to follow it."""
        lower, upper = self.joint.range
        q_ref = min(max(self.q_ref + STEP_AT_FULL_STICK * stick, lower), upper)
        dq_ref = (q_ref - self.q_ref) / self.time_step

        q = self.joint.position
        dq = (q - self.q_prev) / self.time_step
        self.joint.effort = P_GAIN * (q_ref - q) + D_GAIN * (dq_ref - dq)

        self.q_ref, self.q_prev = q_ref, q


def four_axes(message: Joy) -> list[float]:
    """Return the sticks' axes, each in [-1, 1]. An axis that is missing or not finite counts as 0.

    Any program can publish anything, so limit every value before you use it.
    """
    axes = [*message.axes[:4], 0.0, 0.0, 0.0, 0.0][:4]  # there may be a million axes
    return [min(max(axis, -1.0), 1.0) if isfinite(axis) else 0.0 for axis in axes]


def sticks(message: Joy) -> tuple[float, float, float, float]:
    """Return left x, left y, right x, right y, each in [-1, 1] and with a dead zone."""
    left_x, left_y, right_x, right_y = four_axes(message)
    return dead_zone(left_x, 0.2), dead_zone(left_y, 0.2), dead_zone(right_x, 0.15), dead_zone(right_y, 0.15)


def dead_zone(axis: float, width: float) -> float:
    """Return the axis, or 0 if it is near the middle, because a released stick never rests exactly there."""
    return axis if abs(axis) > width else 0.0


def complain(node: Node, message: Joy) -> None:
    """Log which axes are outside the range of a stick, at most once every five seconds."""
    odd = [axis for axis in message.axes[:4] if not -1.0 <= axis <= 1.0]  # NaN fails every comparison
    if odd:
        text = f"the joystick has axes outside -1 to 1: {odd}. They are limited, or count as 0"
        node.get_logger().warning(text, throttle_duration_sec=5.0)
