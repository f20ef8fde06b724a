"""Looking at an answer to `aim`: the torques that it sets for a joint whose motion is known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from math import inf, pi
from typing import Any

from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, judged, right, wrong
from tutorial.checks._watch import watch

__all__ = ["judge_aim"]

WIDE = (-1.5000001, 0.9000001)  # [rad]; a whole number of moves away, and a trace more, from where the scenes begin
NARROW = (-0.1700001, 0.7800001)  # [rad]

MISTAKES = (
    Mistake("start", "zero", "the reference begins at 0: it begins where the joint stands, joint.position."),
    Mistake("kept", False, "the reference is not kept: it moves on from self.q_ref, not from joint.position."),
    Mistake("sign", -1.0, "the sign of the stick is wrong: at a positive stick the reference grows."),
    Mistake("spring", -1.0, "the spring has the wrong sign, it pushes away from the reference: 200 * (q_ref - q)."),
    Mistake("rate", pi / 180, "the rate is converted from degrees: it is 0.002 rad per call."),
    Mistake("rate", 180 / pi, "the rate is converted to degrees: it is 0.002 rad per call."),
    Mistake("rate", "time", "the rate is taken per second: the reference moves by 0.002 rad at every call."),
    Mistake("rate", "2 rad/s", "the move is made from time_step: it is 0.002 rad per call, however long a step is."),
    Mistake("rate", 10.0, "the rate is another: it is 0.002 rad per call, not 0.02."),
    Mistake("rate", 0.1, "the rate is another: it is 0.002 rad per call, not 0.0002."),
    Mistake("stick", "sign", "only the stick's sign counts: half a stick moves the reference by half as much."),
    Mistake("stick", "dead zone", "the stick has a dead zone, as in TankController: here every position of it counts."),
    Mistake("stick", "limited", "joint.range limits the stick: it is the reference, an angle, that stays within it."),
    Mistake(
        "stick", "is angle", "the stick is taken for the angle: it moves the reference, by 0.002 * stick per call."
    ),
    Mistake("stick", "one way", "the stick counts only in one direction: a negative one moves the reference back."),
    Mistake("clamp", "none", "the reference runs away: it has to stay within joint.range."),
    Mistake("clamp", "no lower", "the reference runs away at the lower end: joint.range has two, and both hold."),
    Mistake("clamp", "no upper", "the reference runs away at the upper end: joint.range has two, and both hold."),
    Mistake("clamp", "symmetric", "the upper end is taken for both: the lower one is joint.range[0], not -upper."),
    Mistake("clamp", "at zero", "the lower end is taken to be 0: it is joint.range[0]."),
    Mistake(
        "clamp",
        "late",
        "the limited reference is used but not kept, so it has to come back first: keep the limited one.",
    ),
    Mistake(
        "clamp", "of position", "joint.range limits the joint's position q: it is the reference that stays within."
    ),
    Mistake("gains", (50.0, 200.0), "the two gains are exchanged: 200 for the angle, 50 for the speed."),
    Mistake("gains", (0.0, 50.0), "the spring is missing: 200 * (q_ref - q)."),
    Mistake("gains", (200.0, 200.0), "both gains are 200: it is 50 for the speed."),
    Mistake("gains", (50.0, 50.0), "both gains are 50: it is 200 for the angle."),
    Mistake("damping", "none", "the damping is missing: + 50 * (dq_ref - dq)."),
    Mistake(
        "damping",
        "q only",
        "dq_ref is missing, or always 0: the damping is 50 * (dq_ref - dq), and dq_ref has to be computed before "
        "self.q_ref is overwritten with the new reference.",
    ),
    Mistake(
        "damping",
        "ref only",
        "dq is missing, or always 0: the damping is 50 * (dq_ref - dq), and dq has to be computed before self.q_prev "
        "is overwritten with the new position.",
    ),
    Mistake("damping", "sign", "the damping has the wrong sign: + 50 * (dq_ref - dq)."),
    Mistake("damping", "sum", "dq is added instead of taken away: the damping is 50 * (dq_ref - dq)."),
    Mistake("damping", "stick", "dq_ref is the stick's: at the end of the range the reference stands still."),
    Mistake("damping", "error", "the speed of the reference is q_ref - q: it is how far q_ref itself has moved."),
    Mistake("per", "call", "the speeds are differences: divide them by time_step."),
    Mistake("per", "1 ms", "the time step is taken to be 1 ms: use time_step."),
    Mistake("per", "times", "the speeds are multiplied by time_step: divide by it."),
    Mistake("prev", "fixed", "self.q_prev is never renewed: keep q for the next call."),
    Mistake(
        "prev", "reference", "self.q_prev is set to the reference: keep q, where the joint was, for the next call."
    ),
    Mistake("prev", "zero", "self.q_prev begins at 0, so the first speed is wrong: it begins at joint.position."),
    Mistake("ref", "fixed", "self.q_ref is never renewed: keep q_ref for the next call."),
    Mistake(
        "ref", "at rest", "the reference is set back to the joint when the stick rests: it stays where it was put."
    ),
    Mistake("order", "late", "the torque is set for the old reference: move the reference first."),
    Mistake("set", "added", "the torque is added to the last one, +=: it is set anew at every call, =."),
    Mistake("set", "moved", "nothing is set while the stick rests: the joint has to be held then, too."),
    Mistake("set", "limited", "the torque is limited, which nobody asked for: set it as it is."),
)
OTHERWISE = "Compare with torque = 200 * (q_ref - q) + 50 * (dq_ref - dq)."
TYPED_RANGE = "Most likely the ends of the range are written down as numbers: they are in joint.range."
TYPED_STEP = "Most likely the time step is written down as a number: use time_step."
POSITION = "Most likely the result is set as joint.position: a motor takes a torque, joint.effort."
NO_EFFORT = "Most likely the torque is computed but not set: joint.effort = ..."
RETURNED = "Most likely the torque is only returned, and nobody looks at that: set it, self.joint.effort = ..."
OWN_EFFORT = "Most likely it is set as self.{name}, an attribute of the answer's own: it is self.joint.effort = ..."
CLOCK = (
    "Most likely the computer's clock says how long a call is: it is time_step, however long it takes to compute it."
)
SHARED = (
    "Most likely something is kept on the class, or outside of it, and so shared by all joints: keep it in the object, "
    "self.q_ref = ..., and make it in __init__."
)


@dataclass(frozen=True)
class Scene:
    """A joint's motion, known in advance, and what the stick does.

    Attributes:
        label: what is tried.
        calls: ``(stick, speed, count)``: the stick, the joint's speed [rad/s], and for how many calls.
        time_step: [s].
        begin: where the joint stands at first [rad].
        limits: the joint's range [rad].
        otherwise: what is most likely wrong when this is the first scene that is not as it should be.
    """

    label: str
    calls: tuple[tuple[float, float, int], ...]
    time_step: float = 0.001
    begin: float = 0.1
    limits: tuple[float, float] = NARROW
    otherwise: str = ""

    def moves(self) -> Iterator[tuple[float, float]]:
        """Yield stick and speed [rad/s] for each call."""
        for stick, speed, count in self.calls:
            yield from [(stick, speed)] * count


STILL = (0.0, 0.0, 1)
UP, DOWN = (1.0, 0.0, 60), (-1.0, 0.0, 60)
SCENES = (
    Scene("stick at rest", ((0.0, 0.0, 3),)),
    Scene("10 calls at full stick, the joint held fast", ((1.0, 0.0, 10),)),
    Scene("and then 10 at rest", ((1.0, 0.0, 10), (0.0, 0.0, 10))),
    Scene("half stick down, the joint follows", (STILL, (-0.5, -1.0, 20))),
    Scene("stick at rest, the joint is pushed", ((0.0, 0.0, 2), (0.0, 0.5, 20))),
    Scene("full stick at the end of the range", (UP,), begin=0.7),
    Scene("and then reversed", (UP, (-1.0, 0.0, 1)), begin=0.7),
    Scene("full stick down at the lower end of the range", (DOWN,), begin=-0.1),
    Scene("and then up again", (DOWN, (1.0, 0.0, 1)), begin=-0.1),
    Scene("full stick, with steps of 2 ms", (STILL, (1.0, 0.3, 20)), 0.002, otherwise=TYPED_STEP),
    Scene("full stick, with steps of 5 ms", (STILL, (1.0, 0.3, 9)), 0.005, otherwise=TYPED_STEP),
    Scene("the first call, at full stick", ((1.0, 0.0, 1),)),
    Scene("a tenth of the stick", ((0.1, 0.0, 10),)),
    Scene("the joint is pushed beyond its range", (STILL, (0.0, 0.5, 20)), begin=0.778),
    Scene("a joint with another range, upwards", (UP,), begin=0.86, limits=WIDE, otherwise=TYPED_RANGE),
    Scene("and downwards", (DOWN,), begin=-1.42, limits=WIDE, otherwise=TYPED_RANGE),
)


class Joint:
    """Stands for a `tutorial.body.Joint`; it moves as the scene says, and writes down what is set.

    What a joint has not, begins with an underscore, so that no learner is told of it.

    Attributes:
        name, range, velocity: as a `tutorial.body.Joint` has them.
        _efforts: what was set at each call [N.m]; None where nothing was.
        _moved: whether somebody has set the position.
    """

    __slots__ = ("_efforts", "_moved", "_position", "_scene", "name", "range", "velocity")

    def __init__(self, scene: Scene) -> None:
        self.name = "TURRET_P"
        self.range = scene.limits
        self.velocity = 0.0
        self._efforts: list[float | None] = []
        self._moved = False
        self._position = scene.begin
        self._scene = scene

    @property
    def position(self) -> float:
        """Position [rad]."""
        return self._position

    @position.setter
    def position(self, _value: float) -> None:
        self._moved = True

    @property
    def effort(self) -> float:
        """Torque [N.m] of the last call."""
        efforts = [effort for effort in self._efforts if effort is not None]
        return efforts[-1] if efforts else 0.0

    @effort.setter
    def effort(self, value: float) -> None:
        self._efforts[-1] = float(value)

    def _play(self) -> Iterator[float]:
        """Yield the stick for each call."""
        for stick, speed in self._scene.moves():
            self.velocity = speed
            self._position += speed * self._scene.time_step
            self._efforts.append(None)
            yield stick


def judge_aim(answer: type) -> Iterator[Finding]:
    """Look at an answer to `aim`."""
    shared = SharedState(answer)
    plays = [_Play(answer, scene) for scene in SCENES]
    for play in plays:
        play.go_on()
    joints = [play.joint for play in plays]
    if any(joint._moved for joint in joints):
        yield wrong("aim sets the joint's position", POSITION)
        return
    if all(effort is None for joint in joints for effort in joint._efforts):
        yield wrong("aim sets no torque", _no_effort(plays))
        return
    alone = []
    for scene in SCENES:
        play = _Play(answer, scene)
        play.go_on()
        alone.append(play.joint.effort)
    probes = [Probe(scene.label, (effort,), _say, otherwise=scene.otherwise) for scene, effort in zip(SCENES, alone)]
    all_right = yield from judged(judge_probes(probes, predict, MISTAKES, shared.cause(_otherwise())))
    if all_right:
        yield _judge_two(answer, [joint.effort for joint in joints], shared)


def _otherwise() -> str:
    return CLOCK if "clock" in watch.noted else OTHERWISE


def _judge_two(answer: type, before: Sequence[float], shared: SharedState) -> Finding:
    """Look whether two joints, held at the same time, keep out of each other's way."""
    first, second = (_Play(answer, SCENES[i]) for i in (2, 3))
    for _ in zip_longest(first.calls(), second.calls()):
        pass
    wanted = [numbers[0] for numbers in predict()]
    seen = [*before, first.joint.effort, second.joint.effort]
    if all(abs(a - b) <= 1e-4 * max(1.0, abs(b)) for a, b in zip(seen, [*wanted, wanted[2], wanted[3]])):
        return right("two joints at the same time: each is held for itself")
    return wrong("two joints at the same time: what one does changes the other's torque", shared.cause(SHARED))


def _no_effort(plays: Sequence[_Play]) -> str:
    """Say where the torque went instead."""
    name = next((name for name in ("effort", "torque") if name in getattr(plays[0].held, "__dict__", {})), "")
    if name == "effort":
        return OWN_EFFORT.format(name=name)
    return RETURNED if any(play.returned is not None for play in plays) else NO_EFFORT


class _Play:
    """An answer that holds a joint of its own in a scene.

    Attributes:
        joint: the joint.
        held: the learner's object.
        returned: what the last call returned.
    """

    def __init__(self, answer: type, scene: Scene) -> None:
        self.joint = Joint(scene)
        self.returned: object = None
        with watch.call("__init__"):
            self.held = answer(self.joint, scene.time_step)

    def calls(self) -> Iterator[None]:
        """Make one call after the other."""
        for stick in self.joint._play():
            with watch.call("aim"):
                self.returned = self.held.aim(stick)
            yield

    def go_on(self) -> None:
        """Make all calls."""
        for _ in self.calls():
            pass


def _say(efforts: tuple[float, ...]) -> str:
    return f"{efforts[0]:.1f} N.m".replace("-0.0", "0.0")


def predict(**parts: Any) -> Iterator[tuple[float, ...]]:
    """Compute the last torque [N.m] of each of `SCENES`, right or with some mistakes."""
    model = _Model(**parts)
    for scene in SCENES:
        yield (model.last_effort(scene),)


@dataclass(frozen=True)
class _Model:
    """An answer that is right but for its mistakes; without arguments it is the right one."""

    start: str = "position"
    kept: bool = True
    sign: float = 1.0
    spring: float = 1.0
    rate: float | str = 1.0
    stick: str = "right"
    clamp: str = "right"
    gains: tuple[float, float] = (200.0, 50.0)
    damping: str = "right"
    per: str = "step"
    order: str = "right"
    prev: str = "renewed"
    ref: str = "renewed"
    set: str = "anew"

    def last_effort(self, scene: Scene) -> float:
        """Play one scene."""
        dt = scene.time_step
        over = {"step": dt, "call": 1.0, "1 ms": 0.001, "times": 1 / dt}[self.per]
        factor = self.rate if isinstance(self.rate, float) else {"time": dt, "2 rad/s": dt / 0.001}[self.rate]
        step = 0.002 * self.sign * factor
        q = scene.begin
        q_prev = 0.0 if self.prev == "zero" else q
        stored = begin = 0.0 if self.start == "zero" else q
        total = 0.0
        for given, speed in scene.moves():
            q += speed * dt
            seen = min(max(q, scene.limits[0]), scene.limits[1]) if self.clamp == "of position" else q
            stick = self._stick(given, scene)
            back = not self.kept or (self.ref == "at rest" and given == 0.0)
            old = seen if back else stored
            stored = given if self.stick == "is angle" else old + step * stick
            limited = self._limited(stored, scene)
            if self.clamp != "late":
                stored = limited
            before = self._limited(old, scene) if self.clamp == "late" else old
            moved = step * stick if self.damping == "stick" else limited - (seen if self.damping == "error" else before)
            dq_ref, dq = moved / over, (seen - q_prev) / over
            effort = self.gains[0] * self.spring * ((before if self.order == "late" else limited) - seen)
            effort += self.gains[1] * self._damping(dq_ref, dq)
            q_prev = {"fixed": q_prev, "reference": limited}.get(self.prev, seen)
            stored = begin if self.ref == "fixed" else stored
            total = self._total(total, effort, given)
        return total

    def _stick(self, stick: float, scene: Scene) -> float:
        """Return what the answer makes of the stick."""
        if self.stick == "sign":
            return (stick > 0) - (stick < 0)
        if self.stick == "limited":
            return min(max(stick, scene.limits[0]), scene.limits[1])
        if (self.stick == "dead zone" and abs(stick) <= 0.15) or (self.stick == "one way" and stick < 0):
            return 0.0
        return stick

    def _limited(self, q_ref: float, scene: Scene) -> float:
        """Return the reference, kept within the range as the answer understands it."""
        lower, upper = scene.limits
        lower = {"no lower": -inf, "symmetric": -upper, "at zero": 0.0}.get(self.clamp, lower)
        upper = inf if self.clamp == "no upper" else upper
        return q_ref if self.clamp in ("none", "of position") else min(max(q_ref, lower), upper)

    def _damping(self, dq_ref: float, dq: float) -> float:
        other = {"none": 0.0, "q only": -dq, "ref only": dq_ref, "sign": dq - dq_ref, "sum": dq_ref + dq}
        return other.get(self.damping, dq_ref - dq)

    def _total(self, before: float, effort: float, stick: float) -> float:
        """Return the torque that is set after a call, from the one before and the one that was computed."""
        if self.set == "moved" and stick == 0.0:
            return before
        if self.set == "limited":
            return min(max(effort, -100.0), 100.0)
        return before + effort if self.set == "added" else effort
