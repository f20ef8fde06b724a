"""The visibility and colour of geoms, as in MuJoCo's own viewer."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.body import SHOWN_GROUPS

Array = NDArray[np.float64]

_UNTOUCHED = (0.5, 0.5, 0.5, 1.0)
"""MuJoCo's default colour for geoms. A geom with this colour is drawn in its material's colour (``setMaterial`` in
``engine_vis_visualize.c``)."""


def is_seen(model: mujoco.MjModel, geom: int) -> bool:
    """Return whether a geom is in a visible group and not fully transparent."""
    return bool(model.geom_group[geom] < SHOWN_GROUPS and colour_of(model, geom)[3] > 0)


def takes_material(model: mujoco.MjModel, geom: int) -> bool:
    """Return whether a geom has the colour of its material instead of its own."""
    return bool(model.geom_matid[geom] >= 0 and tuple(model.geom_rgba[geom]) == _UNTOUCHED)


def colour_of(model: mujoco.MjModel, geom: int) -> Array:
    """Return a geom's red, green, blue and opacity values, each from 0 to 1, shape (4,). Textures are ignored."""
    own = not takes_material(model, geom)
    return np.asarray(model.geom_rgba[geom] if own else model.mat_rgba[model.geom_matid[geom]], dtype=float)
