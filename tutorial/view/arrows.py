"""What inertial sensors measure: arrows in the scene that follow the body, and numbers for the table below it."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.description.poses import Matrix, pose
from tutorial.view.shapes import draw_arrow

LONGEST = 1.0
"""No arrow is longer [m], whatever is published."""

LARGEST = 1e6
"""Larger numbers are written as this one, so that the table stays small."""

SMOOTHNESS = 0.7
"""How much of the difference between what is shown and what was measured remains after a frame."""

UNSEEN = 1e-3
"""The scale of a hidden arrow. It is not 0, because a matrix has to have an inverse."""


@dataclass(frozen=True)
class Style:
    """How one kind of sensor is shown.

    Attributes:
        name, unit: of what it measures.
        legend: what the arrow looks like.
        colour: as 0xRRGGBB.
        scale: the arrow's length [m] for one unit.
        threshold: what is smaller has no arrow, in the unit.
        offset: how far above the sensor the arrow begins [m].
    """

    name: str
    unit: str
    legend: str
    colour: int
    scale: float
    threshold: float
    offset: float


STYLES = {
    int(mujoco.mjtSensor.mjSENS_ACCELEROMETER): Style(
        "acceleration", "m/s²", "red arrow: without gravity", 0xD0342C, scale=0.05, threshold=0.5, offset=0.35
    ),
    int(mujoco.mjtSensor.mjSENS_GYRO): Style(
        "angular velocity", "rad/s", "blue arrow", 0x2C5FD0, scale=0.1, threshold=0.05, offset=0.45
    ),
}


class Arrow:
    """One sensor's arrow. It is drawn in the world, from above the sensor into the direction of what was measured.

    Args:
        path: of the arrow in the scene.
        model: the body's.
        sensor: the number of an accelerometer or a gyroscope; what it measures is along the axes of its site.
        style: how to show it.
    """

    def __init__(self, path: str, model: mujoco.MjModel, sensor: int, style: Style) -> None:
        self._path = path
        self._style = style
        self._site = int(model.sensor_objid[sensor])
        self._adr = int(model.sensor_adr[sensor])
        takes_off_gravity = model.sensor_type[sensor] == mujoco.mjtSensor.mjSENS_ACCELEROMETER
        self._gravity: NDArray[np.float64] = model.opt.gravity * takes_off_gravity
        self._measured: NDArray[np.float64] = np.zeros(3)
        self._target: NDArray[np.float64] = np.zeros(3)  # in the world, in the unit
        self._shown: NDArray[np.float64] = np.zeros(3)
        self._origin: NDArray[np.float64] = np.zeros(3)
        self._sent: Matrix | None = None
        self._is_seen = False

    def aim(self, data: mujoco.MjData) -> None:
        """Take over what was measured, and where the sensor is.

        Three zeros mean that nothing was measured, for an accelerometer at rest says 9.8; a number that is not finite
        has no arrow.
        """
        self._measured = data.sensordata[self._adr : self._adr + 3].copy()
        self._origin = data.site_xpos[self._site] + (0.0, 0.0, self._style.offset)
        if self._measured.any() and np.isfinite(self._measured).all():
            turned = data.site_xmat[self._site].reshape(3, 3) @ np.clip(self._measured, -LARGEST, LARGEST)
            self._target = turned + self._gravity
        else:
            self._target = np.zeros(3)

    def step(self) -> Iterator[dict[str, Any]]:
        """Go on by a frame, towards what was measured; yield the commands that draw it, if it has changed.

        The arrow is drawn when there is something to see for the first time.
        """
        difference = self._target - self._shown
        still = np.abs(difference).max() < 0.01 * self._style.threshold
        self._shown = self._target.copy() if still else self._target - SMOOTHNESS * difference
        was_seen, self._is_seen = self._is_seen, float(np.linalg.norm(self._shown)) >= self._style.threshold
        if not (self._is_seen or was_seen):
            return
        matrix = self._matrix()
        if self._sent is None:
            yield {"type": "set_object", "path": self._path, "object": draw_arrow(self._path, self._style.colour)}
        elif (matrix == self._sent).all():
            return
        self._sent = matrix
        yield {"type": "set_transform", "path": self._path, "matrix": matrix}

    def reading(self) -> tuple[str, ...]:
        """Return what was measured: its name, x, y, z, unit and legend. Empty if nothing was."""
        if not self._measured.any():
            return ()
        numbers = (f"{number:z.2f}" for number in np.clip(self._measured, -LARGEST, LARGEST))
        return (self._style.name, *numbers, self._style.unit, self._style.legend)

    def _matrix(self) -> Matrix:
        """The arrow is drawn 1 m long, along z."""
        quaternion = np.empty(4)
        mujoco.mju_quatZ2Vec(quaternion, self._shown)
        length = min(self._style.scale * float(np.linalg.norm(self._shown)), LONGEST)
        matrix = pose(self._origin, quaternion)
        matrix[:3, :3] *= (1.0, 1.0, length) if self._is_seen else UNSEEN
        return matrix.T.reshape(16)


def arrows_of(root: str, model: mujoco.MjModel) -> Iterator[Arrow]:
    """Make the arrows of a model: for its first accelerometer, and for its first gyroscope.

    Args:
        root: the path that they are below.
        model: the body's.
    """
    types = model.sensor_type.tolist()
    for kind, style in STYLES.items():
        if kind in types:
            yield Arrow(f"{root}/{style.name}", model, types.index(kind), style)
