"""Looking at an answer to `aim`: the torques that it sets for a joint whose motion is known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._verdict import Finding, wrong
from tutorial.checks._watch import watch

__all__ = ["judge_aim"]

RANGE = (-0.17, 0.78)  # [rad]

MISTAKES = (
    Mistake("start", "zero", "the reference begins at 0: it begins where the joint stands, joint.position."),
    Mistake("kept", False, "the reference is not kept: it moves on from self.q_ref, not from joint.position."),
    Mistake("sign", -1.0, "the sign of the stick is wrong: at a positive stick the reference grows."),
    Mistake("rate", pi / 180, "the rate is converted from degrees: it is 0.002 rad per call."),
    Mistake("rate", 180 / pi, "the rate is converted to degrees: it is 0.002 rad per call."),
    Mistake("rate", "time", "the rate is taken per second: the reference moves by 0.002 rad at every call."),
    Mistake("clamp", "none", "the reference runs away: it has to stay within joint.range."),
    Mistake(
        "clamp",
        "late",
        "the limited reference is used but not kept, so it has to come back first: keep the limited one.",
    ),
    Mistake("gains", (50.0, 200.0), "the two gains are exchanged: 200 for the angle, 50 for the speed."),
    Mistake("damping", "none", "the damping is missing: + 50 * (dq_ref - dq)."),
    Mistake("damping", "q only", "dq_ref is missing: the damping is 50 * (dq_ref - dq)."),
    Mistake("damping", "ref only", "dq is missing: the damping is 50 * (dq_ref - dq)."),
    Mistake("damping", "sign", "the damping has the wrong sign: + 50 * (dq_ref - dq)."),
    Mistake("damping", "stick", "dq_ref is the stick's: at the end of the range the reference stands still."),
    Mistake("per", "call", "the speeds are differences: divide them by time_step."),
    Mistake("per", "1 ms", "the time step is taken to be 1 ms: use time_step."),
    Mistake("prev", "fixed", "self.q_prev is never renewed: keep q for the next call."),
    Mistake("ref", "fixed", "self.q_ref is never renewed: keep q_ref for the next call."),
    Mistake("order", "late", "the torque is set for the old reference: move the reference first."),
)
OTHERWISE = "Compare with torque = 200 * (q_ref - q) + 50 * (dq_ref - dq)."
POSITION = "Most likely the result is set as joint.position: a motor takes a torque, joint.effort."
NO_EFFORT = "Most likely the torque is computed but not set: joint.effort = ..."


@dataclass(frozen=True)
class Scene:
    """A joint's motion, known in advance, and what the stick does.

    Attributes:
        label: what is tried.
        time_step: [s].
        calls: ``(stick, speed, count)``: the stick, the joint's speed [rad/s], and for how many calls.
        begin: where the joint stands at first [rad].
    """

    label: str
    calls: tuple[tuple[float, float, int], ...]
    time_step: float = 0.001
    begin: float = 0.1

    def moves(self) -> Iterator[tuple[float, float]]:
        """Yield stick and speed [rad/s] for each call."""
        for stick, speed, count in self.calls:
            yield from [(stick, speed)] * count


SCENES = (
    Scene("stick at rest", ((0.0, 0.0, 3),)),
    Scene("10 calls at full stick, the joint held fast", ((1.0, 0.0, 10),)),
    Scene("and then 10 at rest", ((1.0, 0.0, 10), (0.0, 0.0, 10))),
    Scene("half stick down, the joint follows", ((-0.5, -1.0, 20),)),
    Scene("stick at rest, the joint is pushed", ((0.0, 0.0, 2), (0.0, 0.5, 20))),
    Scene("full stick at the end of the range", ((1.0, 0.0, 500),)),
    Scene("and then reversed", ((1.0, 0.0, 500), (-1.0, 0.0, 1))),
    Scene("full stick, with steps of 2 ms", ((1.0, 0.3, 20),), time_step=0.002),
)


class FakeJoint:
    """Stands for a joint; it moves as the scene says, and writes down what is set.

    Attributes:
        name, range, velocity: as a `tutorial.body.Joint` has them.
        efforts: what was set at each call [N.m]; None where nothing was.
        moved: whether somebody has set the position.
    """

    def __init__(self, scene: Scene) -> None:
        self.name = "TURRET_P"
        self.range = RANGE
        self.velocity = 0.0
        self.efforts: list[float | None] = []
        self.moved = False
        self._position = scene.begin
        self._scene = scene

    @property
    def position(self) -> float:
        """Position [rad]."""
        return self._position

    @position.setter
    def position(self, _value: float) -> None:
        self.moved = True

    @property
    def effort(self) -> float:
        """Torque [N.m] of the last call."""
        efforts = [effort for effort in self.efforts if effort is not None]
        return efforts[-1] if efforts else 0.0

    @effort.setter
    def effort(self, value: float) -> None:
        self.efforts[-1] = float(value)

    def play(self) -> Iterator[float]:
        """Yield the stick for each call."""
        for stick, speed in self._scene.moves():
            self.velocity = speed
            self._position += speed * self._scene.time_step
            self.efforts.append(None)
            yield stick


def judge_aim(answer: type) -> Iterator[Finding]:
    """Look at an answer to `aim`."""
    joints = [_play(answer, scene) for scene in SCENES]
    if any(joint.moved for joint in joints):
        yield wrong("aim sets the joint's position", POSITION)
        return
    if all(effort is None for joint in joints for effort in joint.efforts):
        yield wrong("aim sets no torque", NO_EFFORT)
        return
    probes = [Probe(scene.label, (joint.effort,), _say) for scene, joint in zip(SCENES, joints)]
    yield from judge_probes(probes, predict, MISTAKES, OTHERWISE)


def _play(answer: type, scene: Scene) -> FakeJoint:
    joint = FakeJoint(scene)
    with watch.call("__init__"):
        held = answer(joint, scene.time_step)
    for stick in joint.play():
        with watch.call("aim"):
            held.aim(stick)
    return joint


def _say(efforts: tuple[float, ...]) -> str:
    return f"{efforts[0]:.1f} N.m".replace("-0.0", "0.0")


def predict(**parts: Any) -> Sequence[tuple[float, ...]]:
    """Compute the last torque [N.m] of each of `SCENES`, right or with some mistakes."""
    return [(_Model(**parts).last_effort(scene),) for scene in SCENES]


@dataclass(frozen=True)
class _Model:
    """An answer that is right but for its mistakes; without arguments it is the right one."""

    start: str = "position"
    kept: bool = True
    sign: float = 1.0
    rate: float | str = 1.0
    clamp: str = "right"
    gains: tuple[float, float] = (200.0, 50.0)
    damping: str = "right"
    per: str = "step"
    order: str = "right"
    prev: str = "renewed"
    ref: str = "renewed"

    def last_effort(self, scene: Scene) -> float:
        """Play one scene."""
        lower, upper = RANGE
        dt = scene.time_step
        over = {"step": dt, "call": 1.0, "1 ms": 0.001}[self.per]
        step = 0.002 * self.sign * (dt if self.rate == "time" else self.rate)  # type: ignore[operator]
        q = q_prev = scene.begin
        stored = begin = 0.0 if self.start == "zero" else scene.begin
        effort = 0.0
        for stick, speed in scene.moves():
            q += speed * dt
            old = stored if self.kept else q
            stored = old + step * stick
            limited = min(max(stored, lower), upper)
            if self.clamp == "right":
                stored = limited
            used = stored if self.clamp == "none" else limited
            before = min(max(old, lower), upper) if self.clamp == "late" else old
            dq_ref = step * stick / over if self.damping == "stick" else (used - before) / over
            dq = (q - q_prev) / over
            d = {"none": 0.0, "q only": -dq, "ref only": dq_ref, "sign": dq - dq_ref}.get(self.damping, dq_ref - dq)
            effort = self.gains[0] * ((before if self.order == "late" else used) - q) + self.gains[1] * d
            q_prev = q if self.prev == "renewed" else q_prev
            stored = stored if self.ref == "renewed" else begin
        return effort
