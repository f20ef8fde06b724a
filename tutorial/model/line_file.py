"""Reads a YAML file of points as a model: a visible line on the laboratory floor, without collisions."""

from itertools import pairwise
from pathlib import Path
from typing import Annotated

import msgspec
import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.errors import TutorialError
from tutorial.model.yamlfile import YamlFile

SUFFIX = ".yaml"
FLOOR = (3.0, 2.5)  # [m] from the middle of the laboratory to its walls, along x and y
SPACING = 0.1  # [m] approximate distance between neighbouring points on the curve
HEIGHT = 0.006  # [m] above the floor: higher than the pad that the tank starts on
YELLOW = (1.0, 0.8, 0.0, 1.0)
VISUAL, HIDDEN = 1, 4  # MuJoCo's groups
SITE = "LINE_POINT_"

Coordinate = Annotated[float, msgspec.Meta(ge=-10_000, le=10_000)]  # [m]


class _LineFile(msgspec.Struct, forbid_unknown_fields=True):
    """The content of a line file."""

    points: Annotated[list[tuple[Coordinate, Coordinate]], msgspec.Meta(min_length=2)]
    width: Annotated[float, msgspec.Meta(ge=0.01, le=0.2)] = 0.05  # [m]


def read_line(path: Path) -> mujoco.MjSpec | None:
    """Read a line from a file. The line is a smooth curve through the file's points and can cross itself.

    Returns:
        The model: a yellow box for each piece of the curve, and a hidden site at each end of a piece; None if the
        file's name does not end in ``.yaml``.

    Raises:
        TutorialError: the file is malformed, has too few points, or repeats a point, or the curve leaves the floor; the
            error gives the line number in the file, and the fix.
    """
    if path.suffix != SUFFIX:
        return None
    file = YamlFile(path, _LineFile, "line")
    curve = _curve(file)
    spec = mujoco.MjSpec()
    spec.modelname = path.stem
    body = spec.worldbody.add_body(name="LINE")
    for i, point in enumerate(curve):
        body.add_site(name=f"{SITE}{i}", pos=(*point, 0.0), group=HIDDEN)
    for start, end in pairwise(curve):
        dx, dy = end - start
        length, half_yaw = np.hypot(dx, dy), np.arctan2(dy, dx) / 2
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=(*(start + end) / 2, HEIGHT / 2),
            quat=(np.cos(half_yaw), 0, 0, np.sin(half_yaw)),
            size=((length + file.data.width / 4) / 2, file.data.width / 2, HEIGHT / 2),  # boxes overlap to close gaps
            rgba=YELLOW,
            group=VISUAL,
            contype=0,
            conaffinity=0,
        )
    return spec


def line_points(model: mujoco.MjModel, data: mujoco.MjData) -> NDArray[np.float64]:
    """Return the points of the line in a world [m], shape (n, 2), from start to end; n is 0 if there is no line.

    Args:
        model: the world's model.
        data: the world's state, with the positions already computed (``mj_forward`` or ``mj_kinematics``).
    """
    sites = [i for i in range(model.nsite) if model.site(i).name.partition("/")[2].startswith(SITE)]
    points: NDArray[np.float64] = data.site_xpos[sites, :2].reshape(-1, 2)
    return points


def _curve(file: YamlFile[_LineFile]) -> NDArray[np.float64]:
    """Return points on the curve, shape (n, 2). The slope at each point in the file depends on its neighbours."""
    corners = np.array(file.data.points)
    chords = np.hypot(*np.diff(corners, axis=0).T)
    for repeated in np.flatnonzero(chords < 1e-6):
        with file.at("points", int(repeated) + 1):
            raise TutorialError("this point repeats the previous one. Leave it out.")
    slopes = np.gradient(corners, np.concatenate([[0.0], np.cumsum(chords)]), axis=0)
    pieces = []
    for i, chord in enumerate(chords):
        piece = _piece(corners[i : i + 2], slopes[i : i + 2], chord)
        with file.at("points", i):
            _check_floor(piece)
        pieces.append(piece)
    with file.at("points", len(chords)):
        _check_floor(corners[-1:])
    return np.concatenate([*pieces, corners[-1:]])


def _piece(ends: NDArray[np.float64], slopes: NDArray[np.float64], chord: float) -> NDArray[np.float64]:
    """Return points on a cubic Hermite spline, shape (n, 2), excluding its end point.

    Args:
        ends: the start and end points [m], shape (2, 2).
        slopes: the derivatives at both ends with respect to the length along the chord, shape (2, 2).
        chord: the distance between the start and end points [m].
    """
    start, end = ends
    start_slope, end_slope = slopes
    t = np.linspace(0, 1, int(np.ceil(chord / SPACING)), endpoint=False)[:, None]
    points: NDArray[np.float64] = (1 + 2 * t) * (1 - t) ** 2 * start + t**2 * (3 - 2 * t) * end
    points += chord * (t * (1 - t) ** 2 * start_slope - t**2 * (1 - t) * end_slope)
    return points


def _check_floor(points: NDArray[np.float64]) -> None:
    outside = points[(np.abs(points) > FLOOR).any(axis=1)]
    if len(outside):
        (x, y), (half_x, half_y) = outside[0], FLOOR
        raise TutorialError(
            f"the line leaves the floor near this point, at ({x:.2f}, {y:.2f}). "
            f"Keep x within {half_x:g} m and y within {half_y:g} m of the centre of the laboratory."
        )
