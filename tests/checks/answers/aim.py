"""The exercise `aim`: right answers in various styles, and wrong ones."""

import time
from dataclasses import InitVar, dataclass

import numpy as np

from tutorial.checks.aim import HeldJoint, aim

from . import edited


class InOneMethodEach:
    def __init__(self, joint, time_step):
        self.joint, self.dt = joint, time_step
        self.before = joint.position, joint.position

    def limited(self, angle):
        return float(np.clip(angle, *self.joint.range))

    def aim(self, stick):
        now = self.limited(self.before[0] + stick / 500), self.joint.position
        q_ref_rate, q_rate = ((new - old) / self.dt for new, old in zip(now, self.before))
        self.joint.effort = np.float64(200 * (now[0] - now[1]) + 50 * (q_ref_rate - q_rate))
        self.before = now


class ByTheJointsVelocity(HeldJoint):
    def aim(self, stick):
        before, q = self.q_ref, self.joint.position
        self.q_ref = sorted([before + 0.002 * stick, *self.joint.range])[1]
        torque = 200 * (self.q_ref - q) + 50 * ((self.q_ref - before) / self.time_step - self.joint.velocity)
        self.joint.effort = torque
        return torque


class StopsAtTheEnd(HeldJoint):
    def aim(self, stick):
        lower, upper = self.joint.range
        super().aim(stick if lower <= self.q_ref + 0.002 * stick <= upper else 0.0)


@dataclass
class ADataclass:
    joint: object
    time_step: InitVar[float]

    def __post_init__(self, time_step):
        self.held = HeldJoint(self.joint, time_step)

    def aim(self, stick):
        self.held.aim(max(-1, min(stick, 1)))


RIGHT = [InOneMethodEach, ByTheJointsVelocity, StopsAtTheEnd, ADataclass]


class ByTheClock(HeldJoint):
    before = 0.0

    def aim(self, stick):
        now = time.perf_counter()
        self.time_step, self.before = now - self.before, now
        super().aim(stick)


class OneByOne(HeldJoint):
    """Set the spring, then add the damping."""

    def aim(self, stick):
        self.now, self.before = self.q_ref, self.q_prev
        super().aim(stick)
        self.joint.effort = 200 * (self.q_ref - self.joint.position)
        self.joint.effort += 50 * ((self.q_ref - self.now) - (self.q_prev - self.before)) / self.time_step


WRONG = [
    (edited(aim, ("self.joint.effort = 200 * (q_ref - q)", "self.joint.position = q_ref")), "position to the result"),
    (edited(aim, ("= self.joint.range", "= -0.1700001, 0.7800001")), "hard-codes the ends of the range"),
    (edited(aim, ("= time_step", "= 0.001")), "a fixed time step"),
    (ByTheClock, "the computer's clock"),
    (OneByOne, "adds the torque to the previous one with +="),
]
