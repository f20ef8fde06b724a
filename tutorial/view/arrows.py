"""Readings of inertial sensors, as arrows that follow the body, and as numbers for the table below the view."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.description.poses import Matrix, pose
from tutorial.view.shapes import draw_arrow

LONGEST = 1.0
"""Maximum length of an arrow [m], even for larger published values."""

LARGEST = 1e6
"""Measured values are clamped to this magnitude, to keep the table narrow."""

SMOOTHNESS = 0.7
"""The fraction of the difference between the shown and measured vectors that remains after each frame."""

UNSEEN = 1e-3
"""The scale of a hidden arrow. It is not 0, because the matrix has to be invertible."""


@dataclass(frozen=True)
class Style:
    """The arrow and the text of one kind of sensor.

    Attributes:
        name, unit: the measured quantity and its unit.
        legend: a description of the arrow.
        colour: as 0xRRGGBB.
        scale: the arrow's length [m] per unit.
        threshold: the smallest value that is drawn as an arrow, in this unit.
        offset: the height of the arrow's start above the sensor [m].
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
    """One sensor's arrow: it begins above the sensor and points in the measured direction.

    Args:
        path: the arrow's path in the scene.
        model: the body's model.
        sensor: the id of an accelerometer or a gyroscope, which measures in the frame of its site.
        style: how to show the measurement.
    """

    def __init__(self, path: str, model: mujoco.MjModel, sensor: int, style: Style) -> None:
        self._path = path
        self._style = style
        self._site = int(model.sensor_objid[sensor])
        self._adr = int(model.sensor_adr[sensor])
        takes_off_gravity = model.sensor_type[sensor] == mujoco.mjtSensor.mjSENS_ACCELEROMETER
        self._gravity: NDArray[np.float64] = model.opt.gravity * takes_off_gravity
        self._measured: NDArray[np.float64] = np.zeros(3)
        self._target: NDArray[np.float64] = np.zeros(3)  # the measured vector, in the world frame
        self._shown: NDArray[np.float64] = np.zeros(3)
        self._origin: NDArray[np.float64] = np.zeros(3)
        self._sent: Matrix | None = None
        self._is_seen = False

    def aim(self, data: mujoco.MjData) -> None:
        """Aim the arrow along the measured vector, starting above the sensor's current position.

        Three zeros mean that there is no measurement yet, because even at rest, an accelerometer measures 9.8 m/s². No
        arrow is drawn if a number is not finite.
        """
        self._measured = data.sensordata[self._adr : self._adr + 3].copy()
        self._origin = data.site_xpos[self._site] + (0.0, 0.0, self._style.offset)
        if self._measured.any() and np.isfinite(self._measured).all():
            turned = data.site_xmat[self._site].reshape(3, 3) @ np.clip(self._measured, -LARGEST, LARGEST)
            self._target = turned + self._gravity
        else:
            self._target = np.zeros(3)

    def step(self) -> Iterator[dict[str, Any]]:
        """Move the arrow one frame closer to its target; yield the commands that draw it, if it has changed.

        The arrow is added to the scene when it becomes visible for the first time.
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
        """Return the measurement as name, x, y, z, unit and legend; an empty tuple if there is no measurement."""
        if not self._measured.any():
            return ()
        numbers = (f"{number:z.2f}" for number in np.clip(self._measured, -LARGEST, LARGEST))
        return (self._style.name, *numbers, self._style.unit, self._style.legend)

    def _matrix(self) -> Matrix:
        """Return the arrow's transform. Before the transform, the arrow is 1 m long and points along z."""
        quaternion = np.empty(4)
        mujoco.mju_quatZ2Vec(quaternion, self._shown)
        length = min(self._style.scale * float(np.linalg.norm(self._shown)), LONGEST)
        matrix = pose(self._origin, quaternion)
        matrix[:3, :3] *= (1.0, 1.0, length) if self._is_seen else UNSEEN
        return matrix.T.reshape(16)


def arrows_of(root: str, model: mujoco.MjModel) -> Iterator[Arrow]:
    """Make arrows for a model's first accelerometer and its first gyroscope.

    Args:
        root: the path of the arrows' parent in the scene.
        model: the body's model.
    """
    types = model.sensor_type.tolist()
    for kind, style in STYLES.items():
        if kind in types:
            yield Arrow(f"{root}/{style.name}", model, types.index(kind), style)
