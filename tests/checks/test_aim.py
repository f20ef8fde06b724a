"""The exercise `aim`: every wrong answer is told from the others."""

from __future__ import annotations

from math import radians

import pytest

from tutorial.checks.tank_controller import HeldJoint, aim


class Base:
    """Right; each wrong answer changes one of its parts."""

    rate = 0.002

    def __init__(self, joint, time_step):
        self.joint, self.time_step = joint, time_step
        self.q_ref = self.q_prev = joint.position

    def limit(self, q_ref):
        return min(max(q_ref, self.joint.range[0]), self.joint.range[1])

    def torque(self, q_ref, q, dq_ref, dq):
        return 200 * (q_ref - q) + 50 * (dq_ref - dq)

    def aim(self, stick):
        q, q_ref = self.joint.position, self.limit(self.q_ref + self.rate * stick)
        dq_ref, dq = (q_ref - self.q_ref) / self.time_step, (q - self.q_prev) / self.time_step
        self.joint.effort = self.torque(q_ref, q, dq_ref, dq)
        self.q_ref, self.q_prev = q_ref, q


class RunsAway(Base):
    def limit(self, q_ref):
        return q_ref


class SignSwapped(Base):
    rate = -0.002


class NoDamping(Base):
    def torque(self, q_ref, q, dq_ref, dq):
        return 200 * (q_ref - q)


class NoReferenceSpeed(Base):
    def torque(self, q_ref, q, dq_ref, dq):
        return 200 * (q_ref - q) - 50 * dq


class GainsExchanged(Base):
    def torque(self, q_ref, q, dq_ref, dq):
        return 50 * (q_ref - q) + 200 * (dq_ref - dq)


class NotKept(Base):
    def aim(self, stick):
        self.q_ref = self.joint.position
        super().aim(stick)


class Degrees(Base):
    rate = radians(0.002)


class PerSecond(Base):
    def aim(self, stick):
        super().aim(stick * self.time_step)


class NotPerTime(Base):
    def __init__(self, joint, time_step):
        super().__init__(joint, 1.0)


class OneMillisecond(Base):
    def __init__(self, joint, time_step):
        super().__init__(joint, 0.001)


class BeginsAtZero(Base):
    def __init__(self, joint, time_step):
        super().__init__(joint, time_step)
        self.q_ref = 0.0


class LimitedLate(Base):
    """Uses the limited reference, but keeps the other one."""

    def __init__(self, joint, time_step):
        super().__init__(joint, time_step)
        self.stored = joint.position

    def aim(self, stick):
        before, self.stored = self.stored, self.stored + self.rate * stick
        q, q_ref = self.joint.position, self.limit(self.stored)
        dq_ref, dq = (q_ref - self.limit(before)) / self.time_step, (q - self.q_prev) / self.time_step
        self.joint.effort = self.torque(q_ref, q, dq_ref, dq)
        self.q_prev = q


class SetsPosition(Base):
    def aim(self, stick):
        self.joint.position = self.q_ref = self.limit(self.q_ref + 0.002 * stick)


class SetsNothing(Base):
    def aim(self, stick):
        self.q_ref = self.limit(self.q_ref + 0.002 * stick)
        return self.torque(self.q_ref, self.joint.position, 0, 0)


class SomethingElse(Base):
    def torque(self, q_ref, q, dq_ref, dq):
        return 3.3 * q


class KeepsOldPosition(Base):
    def aim(self, stick):
        q_prev = self.q_prev
        super().aim(stick)
        self.q_prev = q_prev


class KeepsOldReference(Base):
    def aim(self, stick):
        q_ref = self.q_ref
        super().aim(stick)
        self.q_ref = q_ref


class WithoutSelf(Base):
    def aim(stick):  # noqa: N805
        stick.joint.effort = 0.0


WRONG = [
    (KeepsOldPosition, "self.q_prev is never renewed: keep q for the next call.", "half stick down"),
    (KeepsOldReference, "self.q_ref is never renewed", "10 calls at full stick"),
    (WithoutSelf, "self is missing: def aim(self, stick):", "aim raised TypeError"),
    (RunsAway, "the reference runs away", "at the end of the range"),
    (LimitedLate, "used but not kept", "and then reversed"),
    (SignSwapped, "the sign of the stick", "10 calls at full stick"),
    (NoDamping, "the damping is missing", "10 calls at full stick"),
    (NoReferenceSpeed, "dq_ref is missing", "10 calls at full stick"),
    (GainsExchanged, "gains are exchanged", "10 calls at full stick"),
    (NotKept, "the reference is not kept", "10 calls at full stick"),
    (Degrees, "converted from degrees", "10 calls at full stick"),
    (PerSecond, "taken per second", "10 calls at full stick"),
    (NotPerTime, "divide them by time_step", "10 calls at full stick"),
    (OneMillisecond, "taken to be 1 ms", "steps of 2 ms"),
    (BeginsAtZero, "begins at 0", "stick at rest"),
    (SetsPosition, "set as joint.position", "sets the joint's position"),
    (SetsNothing, "only returned", "sets no torque"),
    (SomethingElse, "Compare with torque", "stick at rest"),
]


@pytest.mark.parametrize(("answer", "cause", "text"), WRONG, ids=lambda value: getattr(value, "__name__", ""))
def test_a_wrong_answer_gets_its_own_sentence(answer, cause, text):
    verdict = aim.judge(answer)
    assert not verdict.right
    assert [cause in named for named in verdict.causes] == [True], str(verdict)
    assert text in next(finding.text for finding in verdict.findings if not finding.right)


class ByTheJointsVelocity(Base):
    def aim(self, stick):
        q_ref = self.limit(self.q_ref + 0.002 * stick)
        dq_ref = (q_ref - self.q_ref) / self.time_step
        self.joint.effort = self.torque(q_ref, self.joint.position, dq_ref, self.joint.velocity)
        self.q_ref = q_ref


@pytest.mark.parametrize("answer", [HeldJoint, Base, ByTheJointsVelocity])
def test_right_answers_are_right(answer):
    verdict = aim.judge(answer)
    assert verdict.right, str(verdict)


class Raises(Base):
    def torque(self, q_ref, q, dq_ref, dq):
        return 1 / 0


def test_an_exception_is_told_with_its_line():
    verdict = aim.judge(Raises)
    text = str(verdict)
    assert "✗ aim raised ZeroDivisionError: division by zero" in text
    assert "in torque, line" in text
    assert ": return 1 / 0" in text
