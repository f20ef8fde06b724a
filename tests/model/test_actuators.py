"""Commands to a joint: an effort for a motor, a target for a servo, and a clear error otherwise."""

import mujoco
import pytest

from tutorial.body import Body
from tutorial.errors import TutorialError

BODY = '<body name="R/B"><joint name="R/J" axis="0 0 1" damping="2"/><geom size="0.1" mass="1"/><site name="S"/></body>'
TENDON = '<tendon><fixed name="T"><joint joint="R/J" coef="2"/></fixed></tendon>'
PLUGIN = '<extension><plugin plugin="mujoco.pid"/></extension>'
SERVO = '<position name="R/p" joint="R/J" kp="20"/>'


def body_of(*actuators, option='timestep="0.0005"'):
    """Return a body with these actuators, which turns about its only joint, J."""
    text = (
        f'<mujoco><option {option}/><default><default class="geared"><position kp="20" gear="-3"/></default></default>'
        f"{PLUGIN}<worldbody>{BODY}</worldbody>{TENDON}<actuator>{''.join(actuators)}</actuator></mujoco>"
    )
    model = mujoco.MjModel.from_xml_string(text)
    return Body("R", model, mujoco.MjData(model))


def joint_of(*actuators, **option):
    return body_of(*actuators, **option).joint("J")


@pytest.mark.parametrize(
    "actuators",
    [
        ['<motor joint="R/J"/>'],
        ['<motor joint="R/J" gear="50"/>'],
        ['<motor jointinparent="R/J" gear="-0.5"/>'],
        ['<general joint="R/J" gainprm="4" gear="2"/>'],
        ['<general joint="R/J" gaintype="affine" gainprm="4" biastype="affine"/>'],
        ['<motor joint="R/J" gear="3"/>', '<motor joint="R/J"/>'],
        ['<position joint="R/J" gear="0"/>', '<pid tendon="T"/>', '<motor joint="R/J" gear="3"/>'],
        [SERVO.replace("/>", ' group="2"/>'), '<motor joint="R/J" gear="3"/>'],
    ],
)
def test_effort(actuators):
    body = body_of(*actuators, option='actuatorgroupdisable="2"')
    body.joint("J").effort = 0.5
    mujoco.mj_step(body.model, body.data)
    assert body.joint("J").effort == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("actuator", "kind"),
    [
        (SERVO, "a position servo. Set joint.target, or its control signal, body.actuator('p').ctrl."),
        ('<position joint="R/J" timeconst="0.1"/>', "a position servo. Set joint.target."),
        ('<general joint="R/J" gainprm="4" biastype="affine" biasprm="1 -4 -1"/>', "a position servo."),
        ('<velocity joint="R/J"/>', "a velocity servo. Give it a name in the model, and set the control signal, body."),
        ('<intvelocity joint="R/J" actrange="-1 1"/>', "an integrated-velocity servo."),
        ('<damper joint="R/J" ctrlrange="0 1"/>', "a damper."),
        (
            '<cylinder joint="R/J"/>',
            "an actuator whose force follows the control signal with a delay, such as a cylinder.",
        ),
        ('<muscle joint="R/J" lengthrange="0 1"/>', "a muscle."),
        ('<pid joint="R/J"/>', "a PID controller."),
        ('<dcmotor joint="R/J" motorconst="1 1" resistance="1"/>', "a DC motor."),
        ('<plugin joint="R/J" plugin="mujoco.pid"><config key="kp" value="20"/></plugin>', "driven by a plugin."),
        ('<general joint="R/J" dyntype="integrator"/>', "an integrator."),
        ('<general joint="R/J" biastype="affine" biasprm="5"/>', "an actuator with a bias force."),
        (f'<motor joint="R/J"/>{SERVO}', "a position servo."),
    ],
)
def test_effort_without_motor(actuator, kind):
    joint = joint_of(actuator)
    with pytest.raises(TutorialError) as info:
        joint.effort = 0.5
    assert str(info.value).startswith("the joint 'J' does not accept an effort: its actuator ")
    assert f"is {kind}" in str(info.value)


@pytest.mark.parametrize("actuator", ["", '<motor tendon="T"/>', '<motor site="S"/>', '<adhesion body="R/B"/>'])
def test_joint_without_actuator(actuator):
    joint = joint_of(actuator.replace("adhesion", 'adhesion ctrlrange="0 1"'))
    with pytest.raises(TutorialError, match="the joint 'J' has no motor"):
        joint.effort = 0.5
    with pytest.raises(TutorialError, match="the joint 'J' has no position servo"):
        joint.target = 0.5


@pytest.mark.parametrize(
    "actuator",
    [
        SERVO,
        '<position class="geared" joint="R/J"/>',
        '<position joint="R/J" kp="20" timeconst="0.1"/>',
        '<general joint="R/J" gainprm="5" biastype="affine" biasprm="1 -20 -1" gear="2"/>',
        f'<pid tendon="T" kp="0"/><motor joint="R/J"/>{SERVO}',
    ],
)
def test_target(actuator):
    body = body_of(actuator)
    joint = body.joint("J")
    joint.target = 0.3
    assert joint.target == pytest.approx(0.3)
    mujoco.mj_step(body.model, body.data, 10_000)
    assert joint.position == pytest.approx(0.3, abs=1e-3)


@pytest.mark.parametrize(
    ("actuator", "said"),
    [
        ('<motor name="R/m" joint="R/J"/>', "no position servo: its actuator 'm' is a motor. Set joint.effort, or its"),
        ('<velocity name="R/v" joint="R/J"/>', "no position servo: its actuator 'v' is a velocity servo. Set its"),
        ('<intvelocity joint="R/J" actrange="-1 1"/>', "no position servo: its actuator is an integrated-vel"),
        (2 * '<position joint="R/J"/>', "2 position servos. For each one, set the control signal, body.actuator(name)"),
    ],
)
def test_target_without_servo(actuator, said):
    joint = joint_of(actuator)
    with pytest.raises(TutorialError) as info:
        joint.target = 0.5
    assert str(info.value).startswith(f"the joint 'J' has {said}")
    with pytest.raises(TutorialError):
        _ = joint.target


def test_actuator_with_two_controls():
    body = body_of('<pid name="R/a" joint="R/J"/>', '<motor name="R/b" tendon="T"/>')
    body.actuator("b").ctrl = 0.25
    assert body.data.ctrl.tolist() == [0.0, 0.0, 0.25]
