"""The exercise `aim`: hold a joint where the stick has put it.

Write the method `aim` of `HeldJoint`. It is called once per simulation step, with the stick's position between -1 and
1, and holds the joint where the stick has put it:

- The reference starts at the joint's angle. In each call it moves by `0.002 * stick` rad, which is 0.002 rad at full
  deflection and half of that at half deflection. It stays within `joint.range`, a pair (lower, upper).
- The torque is `200 * (q_ref - q) + 50 * (dq_ref - dq)`. Set `joint.effort` [N.m] to this torque in every call, even if
  the stick is at rest. `q` is `joint.position`, and `q_ref` is the reference after it has moved.
- `dq_ref` and `dq` are speeds [rad/s]: the change in `q_ref` and in `q` since the last call, divided by `time_step`.
  You may use `joint.velocity` as `dq`.

Hint 1: Which two numbers does the next call need? Store them in self; both start at the joint's angle. And how far can
the reference go? joint.range has two limits.

Hint 2: Move the reference first, and clamp it to the range. A speed is the change since the last call divided by
time_step, so compute both speeds while you still have the old values. Store the new values at the very end.

Hint 3: q_ref = min(max(self.q_ref + 0.002 * stick, lower), upper), then dq_ref = (q_ref - self.q_ref) /
self.time_step; the same for q = self.joint.position and self.q_prev; then self.joint.effort = ..., and finally
self.q_ref, self.q_prev = q_ref, q.

Notice that the joint responds immediately when you reverse the stick, because the reference stays within the range.
"""

from collections.abc import Callable, Iterator
from math import isnan, nan
from typing import Any

from tutorial.body import Joint
from tutorial.checks.engine.bodies import bodies
from tutorial.checks.engine.cases import Case, Cases, Mistake, both, replace
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise


class HeldJoint:
    """Hold one joint where the stick has put it."""

    def __init__(self, joint: Joint, time_step: float) -> None:
        self.joint = joint
        self.time_step = time_step
        self.q_ref = self.q_prev = joint.position

    def aim(self, stick: float) -> None:
        """Move the reference according to the stick, and set the torque that makes the joint follow it."""
        lower, upper = self.joint.range
        q_ref = min(max(self.q_ref + 0.002 * stick, lower), upper)
        dq_ref = (q_ref - self.q_ref) / self.time_step
        q = self.joint.position
        dq = (q - self.q_prev) / self.time_step
        self.joint.effort = 200 * (q_ref - q) + 50 * (dq_ref - dq)
        self.q_ref, self.q_prev = q_ref, q


MISTAKES = [
    Mistake("your reference starts at 0. Start it at the joint's angle, joint.position.",
            replace("self.q_ref = self.q_prev = joint.position", "self.q_ref, self.q_prev = 0.0, joint.position")),
    Mistake("self.q_prev starts at 0, so the first speed is wrong. Start it at the joint's angle, joint.position.",
            replace("self.q_ref = self.q_prev = joint.position", "self.q_ref, self.q_prev = joint.position, 0.0")),
    Mistake("your code computes the reference from joint.position. Start from the previous reference, self.q_ref.",
            replace("self.q_ref + 0.002 * stick", "self.joint.position + 0.002 * stick")),
    Mistake("your code converts between radians and degrees. 0.002 is "
            "already in radians, as are the angle and the range.",
            replace("0.002", "radians(0.002)", "degrees(0.002)")),
    Mistake("your code multiplies the reference's movement by time_step. The reference moves "
            "by 0.002 * stick rad in each call, whatever the time step.",
            replace("0.002 * stick", "0.002 * stick * self.time_step", "2 * self.time_step * stick")),
    Mistake("your code uses only the sign of the stick's position. At half stick, "
            "the reference moves half as far: 0.002 * stick.",
            replace("0.002 * stick", "0.002 * ((stick > 0) - (stick < 0))")),
    Mistake("your code clamps the stick's position to joint.range, which is a range of angles. "
            "Clamp the reference instead.",
            replace("0.002 * stick", "0.002 * min(max(stick, self.joint.range[0]), self.joint.range[1])")),
    Mistake("your code uses the stick's position as the reference. The stick "
            "moves the reference by 0.002 * stick in each call.",
            replace("self.q_ref + 0.002 * stick", "stick")),
    Mistake("your code doesn't clamp the reference to joint.range. Keep it between joint.range[0] and joint.range[1].",
            replace("= self.joint.range", "= -9.9, 9.9", "= -9.9, self.joint.range[1]", "= self.joint.range[0], 9.9",
                    "= -self.joint.range[1], self.joint.range[1]")),
    Mistake("your code stores the unclamped reference, which takes time to return to the range. "
            "Store the clamped reference.",
            both(replace("min(max(self.q_ref + 0.002 * stick, lower), upper)", "min(max(self.far, lower), upper)"),
                 replace("self.joint = joint", "self.far, self.joint = joint.position, joint"),
                 replace("lower, upper =", "self.far += 0.002 * stick\nlower, upper ="))),
    Mistake("your code swaps the two gains. Use 200 for the angle and 50 for the speed.",
            replace("200 * (q_ref - q) + 50 *", "50 * (q_ref - q) + 200 *")),
    Mistake("your code computes dq_ref from the stick. Compute it from the "
            "clamped reference: (q_ref - self.q_ref) / self.time_step.",
            replace("(q_ref - self.q_ref) /", "0.002 * stick /")),
    Mistake("your code doesn't divide the speeds by time_step. A speed is a change divided by the time that it took.",
            replace("/ self.time_step", "/ 1.0")),
    Mistake("your code multiplies the speeds by time_step. A speed is a change divided by the time that it took.",
            replace("/ self.time_step", "* self.time_step")),
    Mistake("your code doesn't store q in self.q_prev. The next call needs q to compute dq.",
            replace("self.q_ref, self.q_prev = q_ref, q", "self.q_ref = q_ref")),
    Mistake("your code doesn't store q_ref in self.q_ref. The next call starts from q_ref.",
            replace("self.q_ref, self.q_prev = q_ref, q", "self.q_prev = q")),
    Mistake("your code sets self.q_prev to the reference. Set it to the joint's angle, q.",
            replace("self.q_ref, self.q_prev = q_ref, q", "self.q_ref = self.q_prev = q_ref")),
    Mistake("your code computes the torque from the old reference. Move the reference first.",
            replace("(q_ref - q)", "(self.q_ref - q)")),
    Mistake("your code adds the torque to the previous one with +=. Set it with "
            "=: joint.effort still holds the torque from the previous step.",
            both(replace("self.joint.effort =", "self.joint.effort +="),
                 replace("200 * (q_ref - q) + 50 * (dq_ref - dq)", "200 * (q_ref - q) + 50 * (dq_ref - dq)",
                         "50 * (dq_ref - dq)", "200 * (q_ref - q)"))),
    Mistake("your code sets no torque while the stick is at rest. The joint needs a torque even then.",
            replace("lower, upper =", "if not stick: return\nlower, upper =")),
]  # fmt: skip
MEANING = ("Compare your steps with these: move and clamp q_ref, compute both speeds, and set "
           "joint.effort to 200 * (q_ref - q) + 50 * (dq_ref - dq), unclamped.")  # fmt: skip
POSITION = "Your code probably sets joint.position to the result. A motor needs a torque: set joint.effort."

NARROW = (-0.1700001, 0.7800001)  # [rad]; each limit is just over a whole number of moves from every starting angle


Range = tuple[float, float]  # [rad]
Calls = tuple[float, float, int]  # the stick, the joint's speed [rad/s], and the number of calls


def play(
    trial: Trial, *calls: Calls, dt: float = 0.001, begin: float = 0.1, limits: Range = NARROW, name: str = "Rover"
) -> Iterator[float]:
    """Hold a joint of the named body, and yield the torque [N.m] after each call, or NaN if the call did not set it."""
    _, body = bodies(trial, "tank", name)
    joint, motor = body.joint("TURRET_P"), body.actuator("TURRET_P")
    joint.position, joint.range = begin, limits
    held = trial.call(trial.answer, joint, dt)
    for stick, speed, count in calls:
        body.data.qvel[:] = speed
        for _ in range(count):
            motor.ctrl = nan
            joint.position = position = joint.position + joint.velocity * dt
            trial.call(held.aim, stick)
            if joint.position != position:
                raise Failure("aim", Misuse("it sets the joint's position", POSITION))
            body.data.qfrc_actuator[:] = motor.ctrl  # the next call reads this as joint.effort
            yield motor.ctrl


def last(*calls: Calls, **how: Any) -> Callable[[Trial], float]:
    """Observe the torque [N.m] after the last call."""
    return lambda trial: list(play(trial, *calls, **how))[-1]


def two(trial: Trial) -> tuple[float, ...]:
    """Observe the torques [N.m] of two joints that are held alternately."""
    first, second = play(trial, (1.0, 0.0, 10), (0.0, 0.0, 10)), play(trial, STILL, (-0.5, -1.0, 19), name="Tank")
    return list(zip(first, second))[-1]


STILL: Calls = (0.0, 0.0, 1)
UP: Calls = (1.0, 0.0, 60)
CASES = [
    Case("10 calls at full stick, with the joint blocked", last((1.0, 0.0, 10))),
    Case("3 calls with the stick at rest", last((0.0, 0.0, 3))),
    Case("full stick for 10 calls, then at rest for 10", last((1.0, 0.0, 10), (0.0, 0.0, 10))),
    Case("half stick down while the joint follows", last(STILL, (-0.5, -1.0, 20))),
    Case("stick at rest while the joint is pushed", last((0.0, 0.0, 2), (0.0, 0.5, 20))),
    Case("full stick at the end of the range", last(UP, begin=0.7),
         "The reference probably stops too early or too late. Its limits "
         "are joint.range[0] and joint.range[1], in rad."),
    Case("the stick reversed at the end of the range", last(UP, (-1.0, 0.0, 1), begin=0.7)),
    Case("full stick down at the lower end of the range, then up", last((-1.0, 0.0, 60), (1.0, 0.0, 1), begin=-0.1)),
    Case("full stick, with steps of 5 ms", last(STILL, (1.0, 0.3, 9), dt=0.005),
         "Your code probably uses a fixed time step. Use time_step."),
    Case("the first call, at full stick", last((1.0, 0.0, 1))),
    Case("a tenth of full stick", last((0.1, 0.0, 10)),
         "Your code probably ignores small deflections of the stick, or uses only the deflection's sign. "
         "The reference moves by 0.002 * stick."),
    Case("stick at rest while the joint is pushed beyond its range", last(STILL, (0.0, 0.5, 20), begin=0.778)),
    Case("full stick, with a different joint range", last(UP, begin=0.86, limits=(-1.5000001, 0.9000001)),
         "Your code probably hard-codes the ends of the range. Read them from joint.range."),
    Case("two joints in turn", two),
]  # fmt: skip


def describe(torque: Any) -> str:
    """Describe one or more torques [N.m]."""
    if isinstance(torque, tuple):
        return " and ".join(map(describe, torque))
    return "no torque" if isnan(torque) else f"{torque:.1f} N.m".replace("-0.0", "0.0")


aim = Exercise("aim", __doc__, Cases(HeldJoint, CASES, MISTAKES, MEANING, describe))
