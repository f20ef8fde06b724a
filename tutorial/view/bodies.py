"""Draws bodies with meshcat: each MuJoCo body once, and after that only how it moves."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.errors import TutorialError, did_you_mean
from tutorial.handoff import ThreadGuard
from tutorial.view import shapes
from tutorial.view.arrows import Arrow, arrows_of
from tutorial.view.paint import Paint
from tutorial.view.scene import MESHCATS_LIGHTS, Scene, Vector, pack_command

__all__ = ["View"]

ROOT = "/Bodies"

CAMERA: tuple[Vector, Vector] = ((-4.4, -3.4, 2.6), (-0.6, -0.1, 0.0))
"""Where the camera stands at first, and what it looks at [m]."""

CLOSE_UP = np.array([-1.0, -0.8, 0.6])
"""Where the camera stands to look at some bodies, seen from their middle and in terms of their extent."""

GRID = 10.0
"""Half the side of meshcat's grid [m]."""

HEAD = ("", "", "x", "y", "z", "", "")
"""Of the table of what sensors measure."""

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

LIGHTS = {
    "Sky": shapes.light("HemisphereLight", (0, 0, 1), color=0xFFFFFF, groundColor=0xC4C2BE, intensity=0.70),
    "Sun": shapes.light("DirectionalLight", (2, -6, 9), color=0xFFF9F0, intensity=0.45, shadow=SHADOW),
}


class View:
    """The 3D view of a program: bodies by name, drawn into a scene.

    Only the thread that made it may call it. What is drawn is seen after `flush`.

    Args:
        scene: where to draw. Its background, lights, grid and camera are set up.
    """

    def __init__(self, scene: Scene) -> None:
        self._guard = ThreadGuard("the 3D view")
        self._scene = scene
        self._bodies: dict[str, _Poses] = {}
        self._arrows: dict[str, tuple[Arrow, ...]] = {}
        self._measuring: dict[str, tuple[Arrow, ...]] = {}  # of those whose sensors have said something
        self._paints: dict[str, Paint] = {}
        self._furnish()

    @property
    def names(self) -> tuple[str, ...]:
        """What is drawn, in the order in which it was added."""
        return tuple(self._bodies)

    def add(self, name: str, model: mujoco.MjModel) -> None:
        """Draw all MuJoCo bodies of a model, in the pose that the model has to begin with.

        A name that is drawn already is replaced.

        Args:
            name: how `update` and `remove` will call it.
            model: what to draw: its geoms of groups 0 to 2.

        Raises:
            TutorialError: the name is empty or has a slash in it.
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.add")
        if not name or "/" in name:
            raise TutorialError(f"{name!r} cannot be a name in the 3D view. Give one without a slash, like 'Tank'.")
        if name in self._bodies:
            self.remove(name)
        paths, drawings = self._draw(f"{ROOT}/{name}", model)
        self._bodies[name] = _Poses(paths, model)
        self._arrows[name] = tuple(arrows_of(f"{ROOT}/{name}", model))
        self._paints[name] = Paint(name, model, drawings)
        self._show_grid_without_floor()
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        self.update(name, data)

    def update(self, name: str, data: mujoco.MjData) -> None:
        """Move the bodies that have moved since the last time. What stands still costs next to nothing.

        What the data's inertial sensors have measured is shown by arrows, a little smoothed from `flush` to `flush`.

        Args:
            name: as given to `add`.
            data: with the bodies' poses computed (``mj_step``, ``mj_forward`` or ``mj_kinematics``).

        Raises:
            TutorialError: there is nothing of this name, or the data belongs to another model.
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.update")
        for key, command in self._find(name).moved(name, data):
            self._scene.send_packed(key, command)
        if name not in self._measuring and data.sensordata.any():
            self._measuring[name] = self._arrows[name]
        for arrow in self._measuring.get(name, ()):
            arrow.aim(data)

    def readings(self, name: str) -> list[tuple[str, ...]]:
        """Say in numbers what the arrows of something show, as rows of a table; none where nothing was measured.

        Returns:
            Rows of whose it is, what it is, x, y, z, unit and legend.

        Raises:
            TutorialError: there is nothing of this name.
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.readings")
        self._find(name)
        readings = (arrow.reading() for arrow in self._measuring.get(name, ()))
        return [(name, *reading) for reading in readings if reading]

    def show_stale(self, name: str, joints: Collection[str]) -> None:
        """Draw in grey what these joints move, and everything else in its own colours.

        Args:
            name: as given to `add`.
            joints: those that nothing was heard of for a while; in the model they are called ``name/joint``.

        Raises:
            TutorialError: there is nothing of this name.
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.show_stale")
        self._find(name)
        for path, colour in self._paints[name].stale(joints):
            self._set(path, "color", colour)

    def remove(self, name: str) -> None:
        """Take something out of the view.

        Raises:
            TutorialError: there is nothing of this name.
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.remove")
        self._find(name)
        del self._bodies[name], self._arrows[name], self._paints[name]
        self._measuring.pop(name, None)
        self._scene.send_message({"type": "delete", "path": f"{ROOT}/{name}"})
        self._show_grid_without_floor()

    def look_at(self, position: Vector, target: Vector) -> None:
        """Place the camera; x and y are level, z is up.

        Args:
            position: of the camera [m].
            target: the point in the middle of the picture [m].

        Raises:
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.look_at")
        self._scene.look_at(position, target)

    def look_at_bodies(self, *names: str) -> None:
        """Place the camera so that these bodies fill the picture, and make the grid a little larger than they are.

        Raises:
            TutorialError: there is nothing of one of these names.
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.look_at_bodies")
        bodies = [self._find(name) for name in names]
        low = np.min([body.center - body.extent / 2 for body in bodies], axis=0)
        high = np.max([body.center + body.extent / 2 for body in bodies], axis=0)
        center, extent = (low + high) / 2, float(np.max(high - low))
        x, y, z = (center + CLOSE_UP * extent).tolist()
        self._scene.look_at((x, y, z), tuple(center.tolist()))
        self._set("/Grid", "scale", [extent / GRID] * 3)

    def show_grid(self, visible: bool = True) -> None:
        """Show or hide the grid at height 0. By itself it is there as long as no floor is drawn.

        Raises:
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.show_grid")
        self._set("/Grid", "visible", visible)

    def line(self, text: str, readings: Iterable[tuple[str, ...]] = ()) -> None:
        """Say one line under the view, and what `readings` gave for a table below it: see `Scene.line`.

        Raises:
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.line")
        rows = list(readings)
        self._scene.line(text, [HEAD, *rows] if rows else ())

    def flush(self) -> None:
        """Let what was drawn be seen: one message, if anything has changed.

        Raises:
            WrongThreadError: called on another thread than the view's.
        """
        self._guard.check("View.flush")
        for arrows in self._measuring.values():
            for arrow in arrows:
                self._move(arrow)
        self._scene.flush()

    def _move(self, arrow: Arrow) -> None:
        """Have an arrow go on by a frame. It is drawn when there is something to see for the first time."""
        matrix = arrow.step()
        if matrix is None:
            return
        if not arrow.drawn:
            self._set_object(arrow.path, shapes.draw_arrow(arrow.path, arrow.style.colour))
            arrow.drawn = True
        self._scene.send_message({"type": "set_transform", "path": arrow.path, "matrix": matrix})

    def _show_grid_without_floor(self) -> None:
        self.show_grid(not any(poses.has_floor for poses in self._bodies.values()))

    def _find(self, name: str) -> _Poses:
        if name not in self._bodies:
            hint = did_you_mean(name, self._bodies)
            raise TutorialError(f"there is no {name!r} in the 3D view.{hint} Draw it first: add(name, model).")
        return self._bodies[name]

    def _draw(self, root: str, model: mujoco.MjModel) -> tuple[dict[int, str], dict[int, tuple[str, shapes.Json]]]:
        """Draw the geoms, each below its MuJoCo body's path; return the bodies' paths, and the geoms' with drawings."""
        paths: dict[int, str] = {}
        drawings: dict[int, tuple[str, shapes.Json]] = {}
        for geom in range(model.ngeom):
            if not shapes.is_drawn(model, geom):
                continue
            body = int(model.geom_bodyid[geom])
            path = paths.setdefault(body, f"{root}/{_label(model, mujoco.mjtObj.mjOBJ_BODY, body)}")
            leaf = f"{path}/{_label(model, mujoco.mjtObj.mjOBJ_GEOM, geom)}"
            drawings[geom] = leaf, shapes.draw_geom(model, geom, leaf)
            self._set_object(*drawings[geom])
        return paths, drawings

    def _furnish(self) -> None:
        for key, value in SKY.items():
            self._set("/Background", key, value)
        for name in MESHCATS_LIGHTS:
            self._set(f"/Lights/{name}", "visible", False)
        for name, light in LIGHTS.items():
            self._set_object(f"/Lights/{name}", light)
        self._set("/Lights/Sky/<object>", "castShadow", False)  # meshcat asks it of everything; a sky cannot
        self._set("/Axes", "visible", False)
        self._set("/Grid", "position", [0, 0, 0.003])  # on a floor at height 0 the two would flicker
        self._set("/Grid/<object>", "color", [1, 1, 1, 0.4])
        self._set("/Cameras/default/rotated/<object>", "fov", 50)
        self._scene.look_at(*CAMERA)

    def _set(self, path: str, key: str, value: object) -> None:
        self._scene.send_message({"type": "set_property", "path": path, "property": key, "value": value})

    def _set_object(self, path: str, drawing: shapes.Json) -> None:
        self._scene.send_message({"type": "set_object", "path": path, "object": drawing})


def _label(model: mujoco.MjModel, kind: mujoco.mjtObj, number: int) -> str:
    """An element's name as one part of a path, and in the viewer's controls: ``Tank/GUN`` as ``Tank.GUN``."""
    name = mujoco.mj_id2name(model, kind, number)
    return name.replace("/", ".") if name else str(number)


class _Poses:
    """Where the bodies of one model were when they were last sent, and the bytes that say where they are now.

    A packed transform is a head, which never changes, and 16 numbers of 4 bytes.
    """

    def __init__(self, paths: dict[int, str], model: mujoco.MjModel) -> None:
        self.center: NDArray[np.float64] = model.stat.center.copy()
        self.extent = float(model.stat.extent)
        self.has_floor = bool((model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE).any())
        self._ids = np.array(list(paths), dtype=np.intp)
        self._bodies = model.nbody
        self._keys = [("set_transform", path, "") for path in paths.values()]
        whole = [{"type": "set_transform", "path": path, "matrix": np.zeros(16)} for path in paths.values()]
        self._heads = [pack_command(command)[:-64] for command in whole]  # without the numbers, which come last
        self._now: NDArray[np.float32] = np.zeros((len(paths), 4, 4), dtype="<f4")  # column by column
        self._now[:, 3, 3] = 1
        self._sent: NDArray[np.float32] = np.full_like(self._now, np.nan)

    def moved(self, name: str, data: mujoco.MjData) -> list[tuple[tuple[str, str, str], bytes]]:
        """The ``set_transform`` commands of those that are not where they were: (key, packed command).

        What is not finite, or too far away for single precision, stays where it is.
        """
        if len(data.xpos) != self._bodies:
            raise TutorialError(
                f"{name!r} was drawn from a model with {self._bodies} bodies, and this data has "
                f"{len(data.xpos)}. Give data of the same model, or draw it anew: add(name, model)."
            )
        now = self._now
        now[:, :3, :3] = data.xmat[self._ids].reshape(-1, 3, 3).transpose(0, 2, 1)
        with np.errstate(over="ignore"):
            now[:, 3, :3] = data.xpos[self._ids]
        moved = np.flatnonzero((now != self._sent).any(axis=(1, 2)))
        moved = moved[np.isfinite(now[moved]).all(axis=(1, 2))].tolist()
        if not moved:
            return []
        self._sent[moved] = now[moved]
        numbers = now.tobytes()
        return [(self._keys[i], self._heads[i] + numbers[64 * i : 64 * i + 64]) for i in moved]
