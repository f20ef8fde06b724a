"""Displayed and simulated bodies that do not move by themselves."""

import mujoco

from tutorial.body import Body
from tutorial.checks.engine.trial import Trial
from tutorial.handoff import ThreadGuard
from tutorial.system.paths import HOME
from tutorial.world import Placement, compose

MODELS = HOME / "project" / "models"


def bodies(trial: Trial, model: str, name: str) -> tuple[Body, Body]:
    """Return a displayed and a simulated body. Later trials get the same bodies, with the simulated body reset.

    Args:
        trial: the trial, which stores the bodies for later trials.
        model: the body's model file without ``.xml``, or the model itself, as MJCF.
        name: the body's name.
    """
    compiled = trial.reuse(_compile, model, name)
    displayed, simulated = trial.reuse(_two_bodies, compiled, name)
    mujoco.mj_resetData(compiled, simulated.data)
    return displayed, simulated


def displayed_body(trial: Trial, model: str, name: str, guard: ThreadGuard) -> Body:
    """Make a new displayed body with the given guard. See `bodies` for the other arguments."""
    compiled = trial.reuse(_compile, model, name)
    return Body(name, compiled, mujoco.MjData(compiled), guard)


def scratch(trial: Trial, model: str, name: str) -> mujoco.MjData:
    """Return an `MjData` for computations with a body's model. Later trials get the same object."""
    data: mujoco.MjData = trial.reuse(mujoco.MjData, trial.reuse(_compile, model, name))
    return data


def _compile(model: str, name: str) -> mujoco.MjModel:
    if model.startswith("<"):
        return mujoco.MjModel.from_xml_string(model)
    return compose([Placement(name, MODELS / f"{model}.xml")])


def _two_bodies(compiled: mujoco.MjModel, name: str) -> tuple[Body, Body]:
    return Body(name, compiled, mujoco.MjData(compiled)), Body(name, compiled, mujoco.MjData(compiled))
