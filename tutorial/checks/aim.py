"""The exercise `aim`: hold a joint where the stick has put it.

Write the method `aim` of `HeldJoint`. Every step of the simulation calls it once, with the stick's position between
-1 and 1. It holds the joint where the stick has put it:

- the reference angle begins at the joint's angle, moves by 0.002 rad per call at full stick, and stays within
  `joint.range`;
- the torque is `200 * (q_ref - q) + 50 * (dq_ref - dq)`; set it as `joint.effort` [N.m]. `q` is `joint.position`,
  `q_ref` the reference after it has moved; `dq` and `dq_ref` are how fast the two have changed since the last call
  [rad/s]; `joint.velocity` is as good as `dq`. From one call to the next, `time_step` seconds pass.

Hint 1: Look at what has to outlive the call, and so belongs to self: there are two such numbers, and both begin at
the joint's angle. And look at the ends of the range: joint.range has two.

Hint 2: Move the reference first, and limit it. A speed is how far something has moved since the last call, divided by
time_step: compute both speeds while you still have the old values. Store the new ones at the very end.

Hint 3: q_ref = min(max(self.q_ref + 0.002 * stick, lower), upper), then dq_ref = (q_ref - self.q_ref) /
self.time_step; the same for q = self.joint.position and self.q_prev; then self.joint.effort = ..., and in the end
self.q_ref, self.q_prev = q_ref, q.

Notice that a reference which stays within the range answers at once when you reverse the stick.
"""

from collections.abc import Callable, Iterator
from math import isnan, nan
from typing import Any

from tutorial.body import Joint
from tutorial.checks.exercise import Cases, Exercise, Failure, Misuse, Rig, call
from tutorial.controller import SimpleController


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


MISTAKES = """
the reference or self.q_prev begins at 0: both begin where the joint stands, at joint.position.
    self.q_ref = self.q_prev = joint.position => self.q_ref, self.q_prev = 0.0, joint.position
    => self.q_ref, self.q_prev = joint.position, 0.0

the reference begins anew at joint.position, in every call or when the stick rests: it moves on from self.q_ref.
    self.q_ref + 0.002 * stick => self.joint.position + 0.002 * stick
    => (self.q_ref + 0.002 * stick if stick else self.joint.position)

the rate is another, or converted from or to degrees: it is 0.002 rad per call.
    0.002 => 0.02 => 0.0002 => radians(0.002) => degrees(0.002)

the rate is made from time_step: the reference moves by 0.002 rad at every call, however long a step is.
    0.002 * stick => 0.002 * stick * self.time_step => 2 * self.time_step * stick

joint.range limits the stick: it is the reference, an angle, that stays within it.
    0.002 * stick => 0.002 * min(max(stick, self.joint.range[0]), self.joint.range[1])

the stick is taken for the angle: it moves the reference, by 0.002 * stick per call.
    self.q_ref + 0.002 * stick => stick

the reference leaves joint.range, or stops before an end: limit it to both ends, joint.range[0] and joint.range[1].
    = self.joint.range => = -9.9, 9.9 => = -9.9, self.joint.range[1] => = self.joint.range[0], 9.9
    => = -self.joint.range[1], self.joint.range[1] => = 0.0, self.joint.range[1]

the limited reference is used but not kept, so it has to come back first: keep the limited one.
    min(max(self.q_ref + 0.002 * stick, lower), upper) => min(max(self.far, lower), upper)
    self.joint = joint => self.far, self.joint = joint.position, joint
    lower, upper = => self.far += 0.002 * stick // lower, upper =

the two gains are exchanged, or the same: 200 for the angle, 50 for the speed.
    200 * (q_ref - q) + 50 * => 50 * (q_ref - q) + 200 * => 200 * (q_ref - q) + 200 * => 50 * (q_ref - q) + 50 *

dq_ref is made of the stick, or of q: it is how far q_ref itself has moved, (q_ref - self.q_ref) / self.time_step.
    (q_ref - self.q_ref) / => 0.002 * stick / => (q_ref - self.joint.position) /

dq_ref or dq is left out, or always 0, as when self.q_ref or self.q_prev is renewed first: compute both speeds before.
    (dq_ref - dq) => (0.0 - dq) => (dq_ref - 0.0)

the speeds are not divided by time_step, or are multiplied by it: divide both differences.
    / self.time_step => / 1.0 => * self.time_step

self.q_ref or self.q_prev is never renewed: keep q_ref and q in them for the next call.
    self.q_ref, self.q_prev = q_ref, q => self.q_ref = q_ref => self.q_prev = q

self.q_prev is set to the reference: keep q, where the joint was, for the next call.
    self.q_ref, self.q_prev = q_ref, q => self.q_ref = self.q_prev = q_ref

the torque is set for the old reference: move the reference first.
    (q_ref - q) => (self.q_ref - q)

the torque is added to the last one, +=: it is set anew at every call, =.
    self.joint.effort = => self.joint.effort +=

nothing is set while the stick rests, or at an end of the range: the joint has to be held then, too.
    lower, upper = => if not stick: return // lower, upper =
    => lower, upper = self.joint.range // if not lower <= self.q_ref + 0.002 * stick <= upper: return // lower, upper =

#
Compare with torque = 200 * (q_ref - q) + 50 * (dq_ref - dq), of the reference and the speeds after the move.

# a tenth of the stick
Most likely small sticks are ignored, or only the stick's sign counts: the reference moves by 0.002 * stick.

# the end of the range
Most likely the reference stops too early, or too late: joint.range has both ends, in rad, as joint.position is.

# full stick, with steps of 5 ms
Most likely the time step is written down as a number: use time_step.

# a joint with another range
Most likely the ends of the range are written down: they are in joint.range.
"""
POSITION = "Most likely the result is set as joint.position: a motor takes a torque, joint.effort."

NARROW = (-0.1700001, 0.7800001)  # [rad]; a whole number of moves away, and a trace more, from where the cases begin


Range = tuple[float, float]  # [rad]
Calls = tuple[float, float, int]  # the stick, the joint's speed [rad/s], and for how many calls


def play(
    answer: type, *calls: Calls, dt: float = 0.001, begin: float = 0.1, limits: Range = NARROW, name: str = "Rover"
) -> Iterator[float]:
    """Hold a joint of a body of this name, and yield the torque [N.m] after each call; NaN where none was set."""
    body = Rig(SimpleController, name=name).body
    joint, motor = body.joint("TURRET_P"), body.actuator("TURRET_P")
    joint.position, joint.range = begin, limits
    held = call(answer, joint, dt)
    for stick, speed, count in calls:
        body.data.qvel[:] = speed
        for _ in range(count):
            motor.ctrl = nan
            joint.position = position = joint.position + joint.velocity * dt
            call(held.aim, stick)
            if joint.position != position:
                raise Failure("aim", Misuse("it sets the joint's position", POSITION))
            body.data.qfrc_actuator[:] = motor.ctrl  # as it will be when the next call asks for joint.effort
            yield motor.ctrl


def last(*calls: Calls, **how: Any) -> Callable[[type], float]:
    """Observe the torque [N.m] in the end."""
    return lambda answer: list(play(answer, *calls, **how))[-1]


def two(answer: type) -> tuple[float, ...]:
    """Observe the torques [N.m] of two joints that are held in turns."""
    first, second = play(answer, (1.0, 0.0, 10), (0.0, 0.0, 10)), play(answer, STILL, (-0.5, -1.0, 19), name="Tank")
    return list(zip(first, second))[-1]


STILL: Calls = (0.0, 0.0, 1)
UP: Calls = (1.0, 0.0, 60)
TRIED = {
    "10 calls at full stick, the joint held fast": last((1.0, 0.0, 10)),
    "stick at rest": last((0.0, 0.0, 3)),
    "full stick for 10 calls, then at rest for 10": last((1.0, 0.0, 10), (0.0, 0.0, 10)),
    "half stick down, the joint follows": last(STILL, (-0.5, -1.0, 20)),
    "stick at rest, the joint is pushed": last((0.0, 0.0, 2), (0.0, 0.5, 20)),
    "full stick at the end of the range": last(UP, begin=0.7),
    "and then reversed": last(UP, (-1.0, 0.0, 1), begin=0.7),
    "full stick down at the lower end of the range, then up": last((-1.0, 0.0, 60), (1.0, 0.0, 1), begin=-0.1),
    "full stick, with steps of 5 ms": last(STILL, (1.0, 0.3, 9), dt=0.005),
    "the first call, at full stick": last((1.0, 0.0, 1)),
    "a tenth of the stick": last((0.1, 0.0, 10)),
    "the joint is pushed beyond its range": last(STILL, (0.0, 0.5, 20), begin=0.778),
    "a joint with another range": last(UP, begin=0.86, limits=(-1.5000001, 0.9000001)),
    "two joints in turns": two,
}


def say(torque: Any) -> str:
    """Put a torque [N.m], or two, into words."""
    if isinstance(torque, tuple):
        return " and ".join(map(say, torque))
    return "no torque" if isnan(torque) else f"{torque:.1f} N.m".replace("-0.0", "0.0")


aim = Exercise("aim", __doc__, Cases(HeldJoint, TRIED, MISTAKES, say))
