"""The exercise `aim`: hold a joint where the stick has put it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import zip_longest
from math import degrees, radians  # noqa: F401 - what some mistakes need
from typing import Any

from tutorial.checks._cases import Cases, call, mistakes
from tutorial.checks._diagnose import Misuse
from tutorial.checks.exercise import Exercise

__all__ = ["HeldJoint", "aim"]


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


MISTAKES = mistakes("""
the reference begins at 0: it begins where the joint stands, joint.position.
    self.q_ref = self.q_prev = joint.position => self.q_ref, self.q_prev = 0.0, joint.position

the reference is not kept: it moves on from self.q_ref, not from joint.position.
    lower, upper = => self.q_ref = self.joint.position // lower, upper =

the sign of the stick is wrong: at a positive stick the reference grows.
    + 0.002 * => - 0.002 *

the spring has the wrong sign, it pushes away from the reference: 200 * (q_ref - q).
    200 * (q_ref - q) => 200 * (q - q_ref)

the rate is converted from degrees: it is 0.002 rad per call.
    0.002 * stick => radians(0.002) * stick

the rate is converted to degrees: it is 0.002 rad per call.
    0.002 * stick => degrees(0.002) * stick

the rate is taken per second: the reference moves by 0.002 rad at every call.
    0.002 * stick => 0.002 * stick * self.time_step

the move is made from time_step: it is 0.002 rad per call, however long a step is.
    0.002 * stick => 2 * self.time_step * stick

the rate is another: it is 0.002 rad per call, not 0.02.
    0.002 => 0.02

the rate is another: it is 0.002 rad per call, not 0.0002.
    0.002 => 0.0002

only the stick's sign counts: half a stick moves the reference by half as much.
    0.002 * stick => 0.002 * ((stick > 0) - (stick < 0))

the stick has a dead zone, as in TankController: here every position of it counts.
    0.002 * stick => 0.002 * (stick if abs(stick) > 0.15 else 0.0)

joint.range limits the stick: it is the reference, an angle, that stays within it.
    0.002 * stick => 0.002 * min(max(stick, self.joint.range[0]), self.joint.range[1])

the stick is taken for the angle: it moves the reference, by 0.002 * stick per call.
    self.q_ref + 0.002 * stick => stick

the stick counts only in one direction: a negative one moves the reference back.
    0.002 * stick => 0.002 * max(stick, 0.0)

the reference runs away: it has to stay within joint.range.
    lower, upper = self.joint.range => lower, upper = -9.9, 9.9

the reference runs away at the lower end: joint.range has two, and both hold.
    lower, upper = self.joint.range => lower, upper = -9.9, self.joint.range[1]

the reference runs away at the upper end: joint.range has two, and both hold.
    lower, upper = self.joint.range => lower, upper = self.joint.range[0], 9.9

the upper end is taken for both: the lower one is joint.range[0], not -upper.
    lower, upper = self.joint.range => lower, upper = -self.joint.range[1], self.joint.range[1]

the lower end is taken to be 0: it is joint.range[0].
    lower, upper = self.joint.range => lower, upper = 0.0, self.joint.range[1]

the limited reference is used but not kept, so it has to come back first: keep the limited one.
    min(max(self.q_ref + 0.002 * stick, lower), upper) => min(max(self.far, lower), upper)
    self.joint = joint => self.far, self.joint = joint.position, joint
    lower, upper = => self.far += 0.002 * stick // lower, upper =

joint.range limits the joint's position q: it is the reference that stays within.
    min(max(self.q_ref + 0.002 * stick, lower), upper) => self.q_ref + 0.002 * stick
    q = self.joint.position => q = min(max(self.joint.position, lower), upper)

the two gains are exchanged: 200 for the angle, 50 for the speed.
    200 * (q_ref - q) + 50 * (dq_ref - dq) => 50 * (q_ref - q) + 200 * (dq_ref - dq)

the spring is missing: 200 * (q_ref - q).
    200 * (q_ref - q) => 0

both gains are 200: it is 50 for the speed.
    50 * (dq_ref - dq) => 200 * (dq_ref - dq)

both gains are 50: it is 200 for the angle.
    200 * (q_ref - q) => 50 * (q_ref - q)

the damping is missing: + 50 * (dq_ref - dq).
    50 * (dq_ref - dq) => 0

dq_ref is missing, or always 0: the damping is 50 * (dq_ref - dq), and dq_ref has to be computed before self.q_ref is
overwritten with the new reference.
    50 * (dq_ref - dq) => 50 * (0 - dq)

dq is missing, or always 0: the damping is 50 * (dq_ref - dq), and dq has to be computed before self.q_prev is
overwritten with the new position.
    50 * (dq_ref - dq) => 50 * dq_ref

the damping has the wrong sign: + 50 * (dq_ref - dq).
    + 50 * (dq_ref - dq) => - 50 * (dq_ref - dq)

dq is added instead of taken away: the damping is 50 * (dq_ref - dq).
    (dq_ref - dq) => (dq_ref + dq)

dq_ref is the stick's: at the end of the range the reference stands still.
    (q_ref - self.q_ref) / => 0.002 * stick /

the speed of the reference is q_ref - q: it is how far q_ref itself has moved.
    (q_ref - self.q_ref) / => (q_ref - self.joint.position) /

the speeds are differences: divide them by time_step.
    / self.time_step => / 1.0

the time step is taken to be 1 ms: use time_step.
    / self.time_step => / 0.001

the speeds are multiplied by time_step: divide by it.
    / self.time_step => * self.time_step

self.q_prev is never renewed: keep q for the next call.
    self.q_ref, self.q_prev = q_ref, q => self.q_ref = q_ref

self.q_prev is set to the reference: keep q, where the joint was, for the next call.
    self.q_ref, self.q_prev = q_ref, q => self.q_ref = self.q_prev = q_ref

self.q_prev begins at 0, so the first speed is wrong: it begins at joint.position.
    self.q_ref = self.q_prev = joint.position => self.q_ref, self.q_prev = joint.position, 0.0

self.q_ref is never renewed: keep q_ref for the next call.
    self.q_ref, self.q_prev = q_ref, q => self.q_prev = q

the reference is set back to the joint when the stick rests: it stays where it was put.
    lower, upper = => self.q_ref = self.q_ref if stick else self.joint.position // lower, upper =

the torque is set for the old reference: move the reference first.
    (q_ref - q) => (self.q_ref - q)

the torque is added to the last one, +=: it is set anew at every call, =.
    self.joint.effort = => self.joint.effort +=

nothing is set while the stick rests: the joint has to be held then, too.
    lower, upper = => if not stick: return // lower, upper =

the torque is limited, which nobody asked for: set it as it is.
    200 * (q_ref - q) + 50 * (dq_ref - dq) => min(max(200 * (q_ref - q) + 50 * (dq_ref - dq), -100), 100)

the torque is computed but not set: self.joint.effort = ...; nobody looks at what aim returns, or at self.effort.
    self.joint.effort = => effort =
""")
POSITION = "Most likely the result is set as joint.position: a motor takes a torque, joint.effort."
TYPED_STEP = "Most likely the time step is written down as a number: use time_step."
TYPED_RANGE = "Most likely the ends of the range are written down as numbers: they are in joint.range."
OTHERWISE = {
    "": "Compare with torque = 200 * (q_ref - q) + 50 * (dq_ref - dq).",
    "full stick, with steps of 2 ms": TYPED_STEP,
    "full stick, with steps of 5 ms": TYPED_STEP,
    "a joint with another range, upwards": TYPED_RANGE,
    "and downwards": TYPED_RANGE,
}

NARROW = (-0.1700001, 0.7800001)  # [rad]; a whole number of moves away, and a trace more, from where the cases begin
WIDE = (-1.5000001, 0.9000001)  # [rad]


class Joint:
    """Stands for a `tutorial.body.Joint`: it moves as it is told, and keeps what is set.

    What a joint has not begins with an underscore, so that no learner is told of it.

    Attributes:
        name, range, velocity: as a `tutorial.body.Joint` has them.
        _position: [rad].
        _torque: what was set last [N.m]; None for nothing.
    """

    __slots__ = ("_position", "_torque", "name", "range", "velocity")

    def __init__(self, position: float, limits: tuple[float, float]) -> None:
        self.name, self.range, self.velocity = "TURRET_P", limits, 0.0
        self._position = position
        self._torque: float | None = None

    @property
    def position(self) -> float:
        """Position [rad]."""
        return self._position

    @position.setter
    def position(self, _value: float) -> None:
        raise Misuse("it sets the joint's position", POSITION)

    @property
    def effort(self) -> float:
        """Torque [N.m]."""
        return self._torque or 0.0

    @effort.setter
    def effort(self, value: float) -> None:
        self._torque = float(value)


Calls = tuple[float, float, int]  # the stick, the joint's speed [rad/s], and for how many calls


def play(
    answer: type, *calls: Calls, dt: float = 0.001, begin: float = 0.1, limits: tuple[float, float] = NARROW
) -> Iterator[float | None]:
    """Hold a joint, and yield the torque [N.m] after each call."""
    joint = Joint(begin, limits)
    held = call(answer, joint, dt)
    for stick, joint.velocity, count in calls:
        for _ in range(count):
            joint._position += joint.velocity * dt
            call(held.aim, stick)
            yield joint._torque


def last(*calls: Calls, **how: Any) -> Callable[[type], float | None]:
    """Observe the torque [N.m] in the end."""
    return lambda answer: list(play(answer, *calls, **how))[-1]


def two(answer: type) -> list[float | None]:
    """Observe the torques [N.m] of two joints that are held in turns."""
    first, second = play(answer, (1.0, 0.0, 10), (0.0, 0.0, 10)), play(answer, STILL, (-0.5, -1.0, 19))
    return list(list(zip_longest(first, second))[-1])


STILL: Calls = (0.0, 0.0, 1)
UP: Calls = (1.0, 0.0, 60)
DOWN: Calls = (-1.0, 0.0, 60)
TRIED = {
    "stick at rest": last((0.0, 0.0, 3)),
    "10 calls at full stick, the joint held fast": last((1.0, 0.0, 10)),
    "and then 10 at rest": last((1.0, 0.0, 10), (0.0, 0.0, 10)),
    "half stick down, the joint follows": last(STILL, (-0.5, -1.0, 20)),
    "stick at rest, the joint is pushed": last((0.0, 0.0, 2), (0.0, 0.5, 20)),
    "full stick at the end of the range": last(UP, begin=0.7),
    "and then reversed": last(UP, (-1.0, 0.0, 1), begin=0.7),
    "full stick down at the lower end of the range": last(DOWN, begin=-0.1),
    "and then up again": last(DOWN, (1.0, 0.0, 1), begin=-0.1),
    "full stick, with steps of 2 ms": last(STILL, (1.0, 0.3, 20), dt=0.002),
    "full stick, with steps of 5 ms": last(STILL, (1.0, 0.3, 9), dt=0.005),
    "the first call, at full stick": last((1.0, 0.0, 1)),
    "a tenth of the stick": last((0.1, 0.0, 10)),
    "the joint is pushed beyond its range": last(STILL, (0.0, 0.5, 20), begin=0.778),
    "a joint with another range, upwards": last(UP, begin=0.86, limits=WIDE),
    "and downwards": last(DOWN, begin=-1.42, limits=WIDE),
    "two joints in turns": two,
}


def say(torque: Any) -> str:
    """Put a torque [N.m], or two, into words."""
    if isinstance(torque, list):
        return " and ".join(map(say, torque))
    return "no torque" if torque is None else f"{torque:.1f} N.m".replace("-0.0", "0.0")


CASES = Cases(HeldJoint, TRIED, MISTAKES, say, OTHERWISE)

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
    judge=CASES.judge,
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
