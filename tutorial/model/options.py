"""MuJoCo's options. An option applies to the whole world, but any model in the world can set it."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

TIME_STEP = 0.001  # [s]
GRAVITY = (0.0, 0.0, -9.80665)  # [m/s^2], as in the original tutorial

OPTIONS = (
    *("timestep", "impratio", "tolerance", "ls_tolerance", "noslip_tolerance", "ccd_tolerance", "sleep_tolerance"),
    *("gravity", "wind", "magnetic", "density", "viscosity", "o_margin", "o_solref", "o_solimp", "o_friction"),
    *("integrator", "cone", "jacobian", "solver", "iterations", "ls_iterations", "noslip_iterations"),
    *("ccd_iterations", "disableflags", "enableflags", "disableactuator", "sdf_initpoints", "sdf_iterations"),
)
"""The fields of MuJoCo's ``mjOption``, in the order of their bits in ``authored.option``."""

WORDS = {
    "integrator": ("Euler", "RK4", "implicit", "implicitfast", "discrete"),
    "cone": ("pyramidal", "elliptic"),
    "jacobian": ("dense", "sparse", "auto"),
    "solver": ("PGS", "CG", "Newton"),
}
"""The MJCF keywords for the values of MuJoCo's enumerations."""

SIZES = (
    *("memory", "njmax", "nconmax", "nstack", "nkey", "nuserdata", "nuser_body", "nuser_jnt", "nuser_geom"),
    *("nuser_site", "nuser_cam", "nuser_tendon", "nuser_actuator", "nuser_sensor"),
)
"""The attributes of MJCF's ``<size>``."""

Models = Mapping[Path, mujoco.MjSpec]


def set_options(world: mujoco.MjSpec, parts: Sequence[tuple[Path, mujoco.MjSpec]], time_step: float | None) -> str:
    """Set a world's options from its models, and copy them to each model so that MuJoCo can attach the model.

    If all models that set an option agree on its value, the world uses that value. If they do not agree, or if no model
    sets the option, the world uses its own value: the original tutorial's gravity, the integrator ``implicitfast``, and
    MuJoCo's defaults for the rest. A flag, such as ``contact``, differs from its default only if all models change it;
    a group of actuators is disabled only if all models disable it.

    Args:
        world: the world, whose options this function sets.
        parts: the file and the content of each model. This function also sets the models' options.
        time_step: the world's time step [s], which overrides the models' time steps; None to use the models' values.

    Returns:
        A description of the models' options that are not used; empty if all are used.
    """
    models = dict(parts)
    specs = [spec for _, spec in parts]
    world.option.timestep, world.option.gravity = TIME_STEP, GRAVITY
    if not any(spec.flexes for spec in specs):  # implicitfast does not support soft bodies
        world.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    unused = [*_set_values(world, models, time_step), *_set_flags(world, models), *_set_actuator_groups(world, models)]
    for size in SIZES:
        largest = max(getattr(spec, size) for spec in (world, *specs))
        for spec in (world, *specs):
            setattr(spec, size, largest)
    for spec in specs:
        for name in OPTIONS:
            setattr(spec.option, name, getattr(world.option, name))
    if not unused:
        return ""
    return (
        f"The models set different values for options that apply to the whole world: {'; '.join(unused)}. "
        "Set each one to the same value in all models, or omit it everywhere."
    )


def _set_values(world: mujoco.MjSpec, models: Models, time_step: float | None) -> Iterator[str]:
    """Set the numeric and keyword options. Yield a description of each option that the models set differently."""
    for bit, name in enumerate(OPTIONS):
        said = {path: _value(spec, name) for path, spec in models.items() if spec.authored.option >> bit & 1}
        if name == "timestep" and time_step is not None:
            world.option.timestep = time_step
        elif len(set(said.values())) == 1:
            setattr(world.option, name, next(iter(said.values())))
        elif said:
            own = _word(name, _value(world, name))
            yield _contradiction(name, own, {path: _word(name, value) for path, value in said.items()})


def _set_flags(world: mujoco.MjSpec, models: Models) -> Iterator[str]:
    """Set the flags that all models set. Yield a description of each flag that only some models set."""
    for field, kinds, own, other in (
        ("disableflags", mujoco.mjtDisableBit, "enable", "disable"),
        ("enableflags", mujoco.mjtEnableBit, "disable", "enable"),
    ):
        flags = [(name, int(bit)) for name, bit in kinds.__members__.items() if "_" in name]  # skips the flag count
        for name, bit in flags:
            if partly := _set_bit(world, models, field, bit):
                flag = f"flag {name.partition('_')[2].lower()}"
                yield _contradiction(flag, own, dict.fromkeys(partly, other))


def _set_actuator_groups(world: mujoco.MjSpec, models: Models) -> Iterator[str]:
    """Disable the groups of actuators that all models disable. Describe the groups that only some models disable."""
    for group in range(31):
        if partly := _set_bit(world, models, "disableactuator", 1 << group):
            yield _contradiction("actuatorgroupdisable", "empty", dict.fromkeys(partly, str(group)))


def _set_bit(world: mujoco.MjSpec, models: Models, field: str, bit: int) -> list[Path]:
    """Set a bit in the world if all models set it; otherwise, return the models that set it."""
    having = [path for path, spec in models.items() if getattr(spec.option, field) & bit]
    if len(having) < len(models):
        return having
    setattr(world.option, field, getattr(world.option, field) | bit)
    return []


def _value(spec: mujoco.MjSpec, name: str) -> Any:
    value = getattr(spec.option, name)
    return tuple(value.tolist()) if isinstance(value, np.ndarray) else value


def _word(name: str, value: Any) -> str:
    """Format a value as in MJCF."""
    if name in WORDS:
        return WORDS[name][int(value)]
    return " ".join(f"{each:g}" for each in value) if isinstance(value, tuple) else f"{value:g}"


def _contradiction(name: str, own: str, said: Mapping[Path, str]) -> str:
    """Describe the world's value and the values that the models set."""
    return f"{name} is {own} ({', '.join(f'{word} in {path.name}' for path, word in said.items())})"
