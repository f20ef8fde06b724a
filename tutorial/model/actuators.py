"""Commands for joints: the control signals for a motor's effort and for a position servo's target."""

from typing import NamedTuple

import mujoco

from tutorial.errors import TutorialError

ON_JOINT = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))

Dyn, Gain, Bias = mujoco.mjtDyn, mujoco.mjtGain, mujoco.mjtBias

FOLLOWS_CONTROL = (Dyn.mjDYN_NONE, Dyn.mjDYN_FILTER, Dyn.mjDYN_FILTEREXACT)
"""Dynamics that make the actuator's input follow the control signal, immediately or with a delay."""

KINDS = {
    Gain.mjGAIN_MUSCLE: "a muscle",
    Gain.mjGAIN_DCMOTOR: "a DC motor",
    Gain.mjGAIN_PID: "a PID controller",
    Gain.mjGAIN_USER: "a user-defined actuator",
}

CONTROL = "the control signal, body.actuator(name).ctrl"


class Command(NamedTuple):
    """How a command to a joint becomes a control signal: ``ctrl = offset + scale * command``.

    Attributes:
        adr: the index of the control signal in MuJoCo's ``ctrl``.
        scale, offset: the coefficients in this formula.
    """

    adr: int
    scale: float
    offset: float = 0.0


def actuators_of(model: mujoco.MjModel, joint: int) -> list[int]:
    """Return the MuJoCo IDs of the actuators that act on a joint directly, not through a tendon or a site."""
    kinds, joints = model.actuator_trntype.tolist(), model.actuator_trnid[:, 0].tolist()
    return [i for i, kind in enumerate(kinds) if kind in ON_JOINT and joints[i] == joint]


def is_motor(model: mujoco.MjModel, actuator: int) -> bool:
    """Return whether an actuator's force is proportional to its control signal."""
    direct = Dyn(model.actuator_dyntype[actuator]) == Dyn.mjDYN_NONE and not _has_plugin(model, actuator)
    return bool(direct and _gain(model, actuator) and _bias(model, actuator) == [0.0, 0.0, 0.0])


def effort_command(model: mujoco.MjModel, joint: int) -> Command:
    """Return the command that applies a torque [N.m] or a force [N] to a joint.

    Raises:
        TutorialError: the joint has no motor, or another kind of actuator acts on it.
    """
    actuators = _enabled(model, joint)
    for actuator in actuators:
        if not is_motor(model, actuator):
            raise TutorialError(f"{_title(model, joint)} does not accept an effort: {_what(model, actuator)}")
    if not actuators:
        raise TutorialError(
            f"{_title(model, joint)} has no motor. Give it one in the model; if a tendon moves it, set the "
            "control signal of the tendon's actuator, body.actuator(name).ctrl."
        )
    gear = float(model.actuator_gear[actuators[0], 0])
    return Command(int(model.actuator_ctrladr[actuators[0]]), 1 / (gear * _gain(model, actuators[0])))


def target_command(model: mujoco.MjModel, joint: int) -> Command:
    """Return the command that sets the target [rad or m] of a joint's position servo.

    The servo rests where ``gain * ctrl + offset - stiffness * gear * position`` is 0.

    Raises:
        TutorialError: the joint has no position servo, or more than one.
    """
    actuators = _enabled(model, joint)
    servos = [each for each in actuators if _is_position_servo(model, each)]
    if len(servos) > 1:
        raise TutorialError(f"{_title(model, joint)} has {len(servos)} position servos. For each one, set {CONTROL}.")
    if not servos:
        found = f": {_what(model, actuators[0])}" if actuators else ". Give it one in the model."
        raise TutorialError(f"{_title(model, joint)} has no position servo{found}")
    gain, (offset, minus_stiffness, _) = _gain(model, servos[0]), _bias(model, servos[0])
    gear = float(model.actuator_gear[servos[0], 0])
    return Command(int(model.actuator_ctrladr[servos[0]]), -minus_stiffness * gear / gain, -offset / gain)


def _title(model: mujoco.MjModel, joint: int) -> str:
    return f"the joint {model.joint(joint).name.partition('/')[2]!r}"


def _enabled(model: mujoco.MjModel, joint: int) -> list[int]:
    """Return the actuators that can move a joint: those with a nonzero gear, in groups that are not disabled."""
    disabled = int(model.opt.disableactuator)
    groups = model.actuator_group.tolist()
    geared = [each for each in actuators_of(model, joint) if model.actuator_gear[each, 0]]
    return [each for each in geared if not (0 <= groups[each] < 31 and disabled >> groups[each] & 1)]


def _has_plugin(model: mujoco.MjModel, actuator: int) -> bool:
    """Return whether a plugin computes an actuator's force."""
    return bool(model.actuator_plugin[actuator] >= 0)


def _is_position_servo(model: mujoco.MjModel, actuator: int) -> bool:
    direct = Dyn(model.actuator_dyntype[actuator]) in FOLLOWS_CONTROL and not _has_plugin(model, actuator)
    return bool(direct and _gain(model, actuator) and _bias(model, actuator)[1] < 0)


def _gain(model: mujoco.MjModel, actuator: int) -> float:
    """Return the force per unit of the control signal, or 0 if this ratio is not constant."""
    constant, *others = model.actuator_gainprm[actuator, :3].tolist()
    kind = Gain(model.actuator_gaintype[actuator])
    return float(constant) if kind == Gain.mjGAIN_FIXED or (kind == Gain.mjGAIN_AFFINE and not any(others)) else 0.0


def _bias(model: mujoco.MjModel, actuator: int) -> list[float]:
    """Return the coefficients of the force that acts without a control signal: constant, per length, and per velocity.

    The coefficients are NaN if MuJoCo computes the force differently, as for a muscle.
    """
    match Bias(model.actuator_biastype[actuator]):
        case Bias.mjBIAS_NONE:
            return [0.0, 0.0, 0.0]
        case Bias.mjBIAS_AFFINE:
            return [float(each) for each in model.actuator_biasprm[actuator, :3]]
    return [float("nan")] * 3


def _what(model: mujoco.MjModel, actuator: int) -> str:
    """Describe an actuator, and how to command it."""
    name = model.actuator(actuator).name.partition("/")[2]
    ways = []
    if is_motor(model, actuator):
        ways.append("joint.effort")
    if _is_position_servo(model, actuator):
        ways.append("joint.target")
    if name:
        ways.append(f"its control signal, body.actuator({name!r}).ctrl")
    what = f"its actuator {name!r}" if name else "its actuator"
    advice = f"Set {', or '.join(ways)}." if ways else f"Give it a name in the model, and set {CONTROL}."
    return f"{what} is {_kind(model, actuator)}. {advice}"


def _kind(model: mujoco.MjModel, actuator: int) -> str:
    """Return an actuator's kind, such as ``"a motor"``."""
    dynamics, gain = Dyn(model.actuator_dyntype[actuator]), Gain(model.actuator_gaintype[actuator])
    _, stiffness, damping = _bias(model, actuator)
    kinds = (  # the first match is used
        (is_motor(model, actuator), "a motor"),
        (_has_plugin(model, actuator), "driven by a plugin"),
        (gain in KINDS, KINDS.get(gain, "")),
        (dynamics == Dyn.mjDYN_INTEGRATOR and stiffness, "an integrated-velocity servo"),
        (dynamics == Dyn.mjDYN_INTEGRATOR, "an integrator"),
        (_is_position_servo(model, actuator), "a position servo"),
        (
            dynamics != Dyn.mjDYN_NONE,
            "an actuator whose force follows the control signal with a delay, such as a cylinder",
        ),
        (gain == Gain.mjGAIN_AFFINE, "a damper"),
        (damping < 0, "a velocity servo"),
    )
    return next((kind for fits, kind in kinds if fits), "an actuator with a bias force")
