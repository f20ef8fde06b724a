"""Draws bodies with meshcat: the geometry once, and then only movements."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.errors import TutorialError, did_you_mean
from tutorial.view import shapes
from tutorial.view.arrows import Arrow, arrows_of
from tutorial.view.frames import ODOM, Frame, frames_of
from tutorial.view.paint import Paint
from tutorial.view.scene import Scene, Vector

ROOT = "/Bodies"

CAMERA: tuple[Vector, Vector] = ((-4.4, -3.4, 2.6), (-0.6, -0.1, 0.0))
"""The camera's initial position, and the point that it looks at [m]."""

CLOSE_UP = np.array([-1.0, -0.8, 0.6])
"""The camera's position for a close-up, relative to the bodies' centre and as a multiple of their extent."""

GRID = 10.0
"""Half the side length of meshcat's grid [m]."""

AXES = 0.3
"""The length of a frame's axes, as a fraction of the robot's extent, and also the length of `odom`'s axes [m]."""

FLOOR = int(mujoco.mjtGeom.mjGEOM_PLANE)

HEAD = ("", "", "x", "y", "z", "", "")
"""The header of the table of sensor readings."""

SKY = {"top_color": [0.80, 0.87, 0.93], "bottom_color": [0.95, 0.96, 0.97]}

SHADOW = {
    "mapSize": [2048, 2048],
    "bias": -0.0005,
    "normalBias": 0.01,
    "camera": {
        "uuid": "Shadow", "type": "OrthographicCamera", "zoom": 1,
        "left": -6, "right": 6, "top": 6, "bottom": -6, "near": 1, "far": 30,
    },
}  # fmt: skip
"""The sun casts shadows within 6 m of the origin."""

MESHCATS_LIGHTS = ("SpotLight", "PointLightNegativeX", "PointLightPositiveX", "AmbientLight", "FillLight")

LIGHTS = {
    "Sky": shapes.light("HemisphereLight", (0, 0, 1), color=0xFFFFFF, groundColor=0xC4C2BE, intensity=0.70),
    "Sun": shapes.light("DirectionalLight", (2, -6, 9), color=0xFFF9F0, intensity=0.45, shadow=SHADOW),
}


class View:
    """A program's 3D view, which draws named bodies into a scene.

    Use it on the scene's thread. Changes become visible at the next `flush`.

    Args:
        scene: the scene to draw into. The view sets up the scene's background, lights, grid and camera.

    Attributes:
        scene: the scene.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._bodies: dict[str, _Drawn] = {}
        self._frames: dict[str, str] = {}  # the paths of the axes, by frame name
        self._furnish()

    def add(self, name: str, model: mujoco.MjModel) -> None:
        """Draw all MuJoCo bodies of a model in their initial poses.

        Args:
            name: an unused name, without a slash, to pass to `update` and `remove`.
            model: the model. Only its geoms in groups 0 to 2 are drawn.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        root = f"{ROOT}/{name}"
        frames = list(frames_of(name, model))
        paths, geoms = self._draw(root, model, {frame.body for frame in frames})
        for frame in frames:
            self._draw_frame(paths[frame.body], frame, model.stat.extent)
        self._bodies[name] = _Drawn(model, _Poses(paths), tuple(arrows_of(root, model)), Paint(name, model, geoms))
        self._show_grid_without_floor()
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        self.update(name, data)

    def update(self, name: str, data: mujoco.MjData) -> None:
        """Draw the MuJoCo bodies in their current poses. Bodies that have not moved take almost no time.

        Arrows show the measurements of the inertial sensors, slightly smoothed from one `flush` to the next.

        Args:
            name: the name given to `add`.
            data: MuJoCo data for the same model, with the bodies' poses computed (by ``mj_step``, ``mj_forward`` or
                ``mj_kinematics``).

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        body = self._bodies[name]
        for path, matrix in body.poses.moved(data):
            self.scene.send_message({"type": "set_transform", "path": path, "matrix": matrix})
        body.measures = body.measures or bool(data.sensordata.any())
        if body.measures:
            for arrow in body.arrows:
                arrow.aim(data)

    def readings(self, name: str) -> list[tuple[str, ...]]:
        """Return the readings of a body's inertial sensors, except for sensors that have not measured anything yet.

        Returns:
            Rows of body, quantity, x, y, z, unit and legend.
        """
        return [(name, *reading) for arrow in self._bodies[name].arrows if (reading := arrow.reading())]

    def show_stale(self, name: str, joints: Collection[str]) -> None:
        """Show the parts moved by stale joints in grey, and all other parts in their normal colours.

        Args:
            name: the name given to `add`.
            joints: the stale joints, which have no recent position. In the model, they are called ``name/joint``.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        for path, colour in self._bodies[name].paint.stale(joints):
            self._set(path, "color", colour)

    def remove(self, name: str) -> None:
        """Remove a body from the view.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        self.scene.send_message({"type": "delete", "path": f"{ROOT}/{name}"})
        self._frames = {frame: path for frame, path in self._frames.items() if not path.startswith(f"{ROOT}/{name}/")}
        del self._bodies[name]
        self._show_grid_without_floor()

    def look_at_bodies(self, *names: str) -> None:
        """Place the camera so that these bodies fill the view, and scale the grid to their size.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        sizes = [self._bodies[name].model.stat for name in names]
        low = np.min([size.center - size.extent / 2 for size in sizes], axis=0)
        high = np.max([size.center + size.extent / 2 for size in sizes], axis=0)
        center, extent = (low + high) / 2, float(np.max(high - low))
        x, y, z = (center + CLOSE_UP * extent).tolist()
        self.scene.look_at((x, y, z), tuple(center.tolist()))
        self._set("/Grid", "scale", [extent / GRID] * 3)

    def show_frames(self, *names: str) -> None:
        """Show the axes of these frames, and hide the axes of all other frames.

        Args:
            names: frames such as ``"odom"`` and ``"Tank/base_link"``; see `frame_names`.

        Raises:
            TutorialError: there is no such frame.
            WrongThreadError: this is not the scene's thread.
        """
        for name in names:
            if name not in self._frames:
                known = ", ".join(self._frames)
                raise TutorialError(
                    f"there is no frame {name!r}.{did_you_mean(name, self._frames)} The frames are {known}."
                )
        for name, path in self._frames.items():
            self._set(path, "visible", name in names)

    @property
    def frame_names(self) -> tuple[str, ...]:
        """The frames that have axes: `odom`, and the frames of the drawn robots."""
        return tuple(self._frames)

    def line(self, text: str, readings: Iterable[tuple[str, ...]] = ()) -> None:
        """Write one line below the view, and the rows of `readings` as a table below that line: see `Scene.line`.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        rows = list(readings)
        self.scene.line(text, [HEAD, *rows] if rows else ())

    def flush(self) -> None:
        """Send all changes as one message, if anything has changed.

        Raises:
            WrongThreadError: this is not the scene's thread.
        """
        for body in self._bodies.values():
            for arrow in body.arrows if body.measures else ():
                for command in arrow.step():
                    self.scene.send_message(command)
        self.scene.flush()

    def _show_grid_without_floor(self) -> None:
        """Show the grid only while no floor is drawn."""
        has_floor = any(FLOOR in body.model.geom_type for body in self._bodies.values())
        self._set("/Grid", "visible", not has_floor)

    def _draw(self, root: str, model: mujoco.MjModel, more: Collection[int]) -> tuple[dict[int, str], dict[int, str]]:
        """Draw the geoms, each under its MuJoCo body's path; return the paths of the bodies and of the geoms.

        The paths of the bodies in `more` are included even if those bodies have no geoms.
        """
        bodies = {body: f"{root}/{_label(model.body(body))}" for body in sorted(more)}
        geoms: dict[int, str] = {}
        for geom in filter(lambda geom: shapes.is_drawn(model, geom), range(model.ngeom)):
            body = int(model.geom_bodyid[geom])
            path = bodies.setdefault(body, f"{root}/{_label(model.body(body))}")
            geoms[geom] = f"{path}/{_label(model.geom(geom))}"
            self._set_object(geoms[geom], shapes.draw_geom(model, geom, geoms[geom]))
        return bodies, geoms

    def _draw_frame(self, path: str, frame: Frame, extent: float) -> None:
        """Add the axes of a frame under its body's path, hidden at first. static/camera.js also uses these paths."""
        own = self._frames[frame.name] = f"{path}/frames/{frame.name.replace('/', '.')}"
        self._set_object(f"{own}/axes", shapes.draw_axes(own, frame.name, AXES * extent, frame.pose, frame.label))
        self._set(own, "visible", False)

    def _furnish(self) -> None:
        for key, value in SKY.items():
            self._set("/Background", key, value)
        for name in MESHCATS_LIGHTS:
            self._set(f"/Lights/{name}", "visible", False)
        for name, light in LIGHTS.items():
            self._set_object(f"/Lights/{name}", light)
        self._set("/Lights/Sky/<object>", "castShadow", False)  # meshcat enables this, but skylight casts no shadows
        self._set("/Axes", "visible", False)
        self._draw_frame("", Frame(ODOM, 0, np.eye(4)), 1.0)
        self._set("/Grid", "position", [0, 0, 0.003])  # at height 0, the grid would flicker against a floor
        self._set("/Grid/<object>", "color", [1, 1, 1, 0.4])
        self._set("/Cameras/default/rotated/<object>", "fov", 50)
        self.scene.look_at(*CAMERA)

    def _set(self, path: str, key: str, value: object) -> None:
        self.scene.send_message({"type": "set_property", "path": path, "property": key, "value": value})

    def _set_object(self, path: str, drawing: shapes.Json) -> None:
        self.scene.send_message({"type": "set_object", "path": path, "object": drawing})


def _label(element: Any) -> str:
    """Return an element's name as a path segment, such as ``Tank.GUN`` for ``Tank/GUN``; its id if it has no name."""
    return str(element.name.replace("/", ".") or element.id)


@dataclass
class _Drawn:
    """A drawn body."""

    model: mujoco.MjModel
    poses: _Poses
    arrows: tuple[Arrow, ...]
    paint: Paint
    measures: bool = False  # whether the body's sensors have measured anything yet


class _Poses:
    """The last poses that were sent for one model's bodies."""

    def __init__(self, paths: dict[int, str]) -> None:
        self._ids = np.array(list(paths), dtype=np.intp)
        self._paths = list(paths.values())
        self._now: NDArray[np.float32] = np.zeros((len(paths), 4, 4), dtype="<f4")  # column by column
        self._now[:, 3, 3] = 1
        self._sent: NDArray[np.float32] = np.full_like(self._now, np.nan)

    def moved(self, data: mujoco.MjData) -> list[tuple[str, NDArray[np.float32]]]:
        """Return the path and the matrix of each body that has moved.

        A body is left where it was if its pose is not finite, or if it is too far away for single precision.
        """
        now = self._now
        now[:, :3, :3] = data.xmat[self._ids].reshape(-1, 3, 3).transpose(0, 2, 1)
        with np.errstate(over="ignore"):
            now[:, 3, :3] = data.xpos[self._ids]
        moved = np.flatnonzero((now != self._sent).any(axis=(1, 2)))
        moved = moved[np.isfinite(now[moved]).all(axis=(1, 2))].tolist()
        self._sent[moved] = now[moved]
        return [(self._paths[i], now[i]) for i in moved]
