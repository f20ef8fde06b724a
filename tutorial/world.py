"""Composing one MuJoCo model out of the bodies that a project lists."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import mujoco

from tutorial.errors import TutorialError
from tutorial.mujoco_warnings import mujoco_warns

FAILS = (ValueError, RuntimeError)
"""What MuJoCo raises of a model: RuntimeError where there is no memory for it."""

mujoco.set_mju_user_warning(mujoco_warns)


@dataclass(frozen=True)
class Placement:
    """Where a body stands in the world, and which model it is.

    Attributes:
        name: the body's name; its elements are called ``name/element`` in the composed model.
        model: path of its MJCF file.
        position: of the model's origin in the world [m], (x, y, z).
        orientation_wxyz: as a unit quaternion in MuJoCo's order, (w, x, y, z).
    """

    name: str
    model: Path
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation_wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


def compose(placements: Iterable[Placement], time_step: float = 0.001) -> mujoco.MjModel:
    """Make one world of several bodies.

    MuJoCo's options belong to the world: whatever the parts ask for, the composed model has this time step, the
    gravity of the original (9.80665 m/s^2) and the integrator ``implicitfast``.

    Args:
        placements: the bodies, each attached with the prefix ``name/``.
        time_step: of the simulation [s].

    Returns:
        The compiled model.

    Raises:
        TutorialError: a model does not load or the whole does not compile; the text is MuJoCo's.
    """
    world = world_spec(placements, time_step)
    try:
        model = world.compile()
        model.names.decode()  # what is in other encodings compiles, and then has no names
    except FAILS as error:
        raise TutorialError(f"the world does not compile. MuJoCo says: {error}") from error
    return model


def world_spec(placements: Iterable[Placement], time_step: float = 0.001) -> mujoco.MjSpec:
    """Make what `compose` compiles, with the same arguments.

    Raises:
        TutorialError: a model does not load; the text is MuJoCo's.
    """
    world = mujoco.MjSpec()
    world.modelname = "world"
    world.option.timestep = time_step
    world.option.gravity = (0.0, 0.0, -9.80665)
    world.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    for placement in placements:
        try:
            str(placement.model).encode()  # MuJoCo takes names in UTF-8 alone
            part = mujoco.MjSpec.from_file(str(placement.model))
            part.option.timestep = time_step
            part.option.gravity = world.option.gravity
            part.option.integrator = world.option.integrator
            frame = world.worldbody.add_frame(pos=placement.position, quat=placement.orientation_wxyz)
            world.attach(part, prefix=f"{placement.name}/", frame=frame)
        except FAILS as error:
            raise TutorialError(f"the model {str(placement.model)!r} does not load. MuJoCo says: {error}") from error
    return world
