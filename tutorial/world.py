"""Composes one MuJoCo model from the bodies of a project."""

import logging
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import mujoco

from tutorial.errors import TutorialError, did_you_mean
from tutorial.model.line_file import read_line
from tutorial.model.mujoco_warnings import mujoco_warns, no_python_warnings
from tutorial.model.options import set_options
from tutorial.model.urdf_file import read_urdf

FAILS = (ValueError, RuntimeError)
"""The errors that MuJoCo raises if it cannot load or compile a model; RuntimeError if it runs out of memory."""

mujoco.set_mju_user_warning(mujoco_warns)

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Placement:
    """A body's name, model and pose in the world.

    Attributes:
        name: the body's name; its elements are called ``name/element`` in the composed model.
        model: the path of its MJCF or URDF file, or of a line's YAML file (`tutorial.model.line_file`).
        position: the position of the model's origin in the world [m], (x, y, z).
        orientation_wxyz: a unit quaternion in MuJoCo's order, (w, x, y, z).
        without: the names of the geoms to omit from the model.
    """

    name: str
    model: Path
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    orientation_wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    without: tuple[str, ...] = ()


def compose(placements: Iterable[Placement], time_step: float | None = None) -> mujoco.MjModel:
    """Compile one world from several bodies.

    The world has the options that its models set, unless the models contradict each other (`tutorial.model.options`).

    Args:
        placements: the bodies, each attached with the prefix ``name/``.
        time_step: the simulation's time step [s]; None to use the models' time steps.

    Returns:
        The compiled model.

    Raises:
        TutorialError: a model cannot be loaded, or the world cannot be compiled; the error quotes MuJoCo's message.
    """
    world, unused = _make_world(placements, time_step)
    try:
        with no_python_warnings():
            model = world.compile()
        model.names.decode()  # MuJoCo accepts names that are not UTF-8, but cannot return them
    except FAILS as error:
        raise TutorialError(f"the world does not compile. MuJoCo reports: {error}\n{unused}".rstrip()) from error
    if unused:
        _log.warning("%s", unused)
    return model


def world_spec(placements: Iterable[Placement], time_step: float | None = None) -> mujoco.MjSpec:
    """Return the spec that `compose` would compile for the same arguments.

    Raises:
        TutorialError: a model cannot be loaded; the error quotes MuJoCo's message.
    """
    return _make_world(placements, time_step)[0]


def _make_world(placements: Iterable[Placement], time_step: float | None) -> tuple[mujoco.MjSpec, str]:
    """Make a world, and describe which of its models' options it does not use."""
    placements = list(placements)
    parts = [_read(placement) for placement in placements]
    world = mujoco.MjSpec()
    world.modelname = "world"
    unused = set_options(world, [(each.model, part) for each, part in zip(placements, parts)], time_step)
    for placement, part in zip(placements, parts):
        try:
            frame = world.worldbody.add_frame(pos=placement.position, quat=placement.orientation_wxyz)
            with no_python_warnings():
                world.attach(part, prefix=f"{placement.name}/", frame=frame)
        except FAILS as error:
            raise _does_not_load(placement.model, error) from error
    return world, unused


def _read(placement: Placement) -> mujoco.MjSpec:
    """Read a model (an MJCF file, a URDF or a line), and remove the geoms to omit."""
    path = placement.model
    try:
        str(path).encode()  # MuJoCo accepts only file names in UTF-8
        with no_python_warnings():
            spec = read_line(path) or read_urdf(path) or mujoco.MjSpec.from_file(str(path))
    except FAILS as error:
        raise _does_not_load(path, error) from error
    for name in placement.without:
        geom = spec.geom(name)
        if geom is None:
            known = [each.name for each in spec.geoms if each.name]
            raise TutorialError(f"{path.name} has no geom {name!r}.{did_you_mean(name, known)}")
        spec.delete(geom)
    return spec


def _does_not_load(path: Path, error: Exception) -> TutorialError:
    return TutorialError(f"the model {str(path)!r} does not load. MuJoCo reports: {error}")
