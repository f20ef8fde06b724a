"""A joint's limits and losses in URDF: range, effort, velocity, damping and friction."""

from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np

from tutorial.description.poses import numbers
from tutorial.model.actuators import actuators_of, is_motor

UNLIMITED = 1e9
"""Represents "no limit" [rad, m, N.m, N, rad/s or m/s], because URDF requires a number."""


def add_limit(element: Element, model: mujoco.MjModel, joint: int) -> None:
    """Add a ``<limit>``: the effort, the velocity and, for a limited joint or a slide joint, the range.

    MuJoCo does not limit velocities, so a model gives the velocity limit as the joint's ``user`` value.
    """
    fastest = max((*model.jnt_user[joint], 0.0)[0], 0.0) or UNLIMITED
    limit = {"effort": numbers([_effort(model, joint)]), "velocity": numbers([fastest])}
    if model.jnt_limited[joint] or model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE:
        lower, upper = model.jnt_range[joint] if model.jnt_limited[joint] else (-UNLIMITED, UNLIMITED)
        limit = {"lower": numbers([lower]), "upper": numbers([upper]), **limit}
    SubElement(element, "limit", limit)


def add_dynamics(element: Element, model: mujoco.MjModel, joint: int) -> None:
    """Add the joint's damping [N.m.s/rad or N.s/m] and friction [N.m or N] as ``<dynamics>``, if they are not zero."""
    dof = model.jnt_dofadr[joint]
    damping, friction = model.dof_damping[dof], model.dof_frictionloss[dof]
    if damping or friction:
        SubElement(element, "dynamics", damping=numbers([damping]), friction=numbers([friction]))


def _effort(model: mujoco.MjModel, joint: int) -> float:
    """Return a joint's maximum torque or force [N.m or N]: its own limit, or the sum of its actuators' limits."""
    if model.jnt_actfrclimited[joint]:
        return float(np.abs(model.jnt_actfrcrange[joint]).max())
    actuators = actuators_of(model, joint)
    together = sum(_strength(model, actuator) for actuator in actuators)
    return min(together, UNLIMITED) if actuators else UNLIMITED


def _strength(model: mujoco.MjModel, actuator: int) -> float:
    gear = abs(float(model.actuator_gear[actuator, 0]))
    if model.actuator_forcelimited[actuator]:
        return gear * float(np.abs(model.actuator_forcerange[actuator]).max())
    adr = model.actuator_ctrladr[actuator]
    if is_motor(model, actuator) and model.actuator_ctrllimited[adr]:
        largest = float(np.abs(model.actuator_ctrlrange[adr]).max())
        return gear * abs(float(model.actuator_gainprm[actuator, 0])) * largest
    return UNLIMITED
