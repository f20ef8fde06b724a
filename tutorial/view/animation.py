"""Turns the messages of a scene over time into one message: all there was to see, and an animation that moves it.

That is what meshcat calls an animation: of each object that moves, its poses and their times.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from tutorial.view.scene import Record, Scene, unpack_command, unpack_records

__all__ = ["Frame", "animated", "lines"]


@dataclass(frozen=True)
class Frame:
    """What a scene said at one time.

    Attributes:
        time: of the run [s].
        message: the scene's; empty where nothing changed.
        joints: by "body joint", its position [rad], or [m] of one that slides.
    """

    time: float
    message: bytes
    joints: dict[str, float]


def animated(frames: Iterable[Frame]) -> bytes:
    """Join the messages of frames, the earliest first, into one that shows all there ever was, and moves it."""
    film = _Film()
    for frame in frames:
        film.add(frame)
    return film.finish()


def lines(frames: Iterable[Frame]) -> Iterator[tuple[float, str]]:
    """Yield what stood below the view: (since when [s], text)."""
    for frame in frames:
        for kind, payload in unpack_records(frame.message):
            if kind is Record.LINE:
                yield round(frame.time, 3), payload.decode()


class _Film:
    """The frames so far: a scene with all that was drawn, and what became of it over time."""

    def __init__(self) -> None:
        self._scene = Scene()
        self._tracks: dict[str, _Track] = {}
        self._sights: dict[str, _Sight] = {}
        self._before = self._now = 0.0
        self._has_camera = False

    def add(self, frame: Frame) -> None:
        self._before, self._now = self._now, frame.time
        for kind, payload in unpack_records(frame.message):
            if kind is Record.COMMAND:
                self._take(unpack_command(payload))
            elif kind is Record.CAMERA and not self._has_camera:  # one looks from where one looked at first
                self._has_camera = True
                numbers = np.frombuffer(payload, "<f8").tolist()
                self._scene.look_at(tuple(numbers[:3]), tuple(numbers[3:]))

    def finish(self) -> bytes:
        moving = [track.lower(path) for path, track in self._tracks.items() if len(track.times) > 1]
        moving += [sight.lower(path) for path, sight in self._sights.items() if len(sight.times) > 1]
        animation = {"type": "set_animation", "path": "", "animations": moving, "options": {"play": False}}
        self._scene.send_message(animation)
        return self._scene.snapshot()

    def _take(self, command: dict[str, Any]) -> None:
        match command["type"]:
            case "delete":
                self._hide(command["path"])
            case "set_transform":
                self._move(command)
            case "set_object":
                self._sights.setdefault(command["path"], _Sight(self._now)).change(self._now, True)
                self._scene.send_message(command)
            case "set_property" if command["property"] == "color" and command["path"].startswith("/Bodies/"):
                pass  # what was stale at the end has not been so all along; the line below says when it was
            case _:
                self._scene.send_message(command)

    def _hide(self, path: str) -> None:
        for drawn, sight in self._sights.items():
            if f"{drawn}/".startswith(f"{path}/"):
                sight.change(self._now, False)

    def _move(self, command: dict[str, Any]) -> None:
        matrix = np.array(command["matrix"], dtype=np.float64)
        if not np.isfinite(matrix).all():
            return
        if track := self._tracks.get(command["path"]):
            track.add(self._now, self._before, matrix)
        else:
            self._tracks[command["path"]] = _Track(self._now, matrix)
            self._scene.send_message(command)


class _Track:
    """The poses of one object. In between two of them it moves evenly; where it stands still it has no poses."""

    def __init__(self, time: float, matrix: NDArray[np.float64]) -> None:
        self.times = [time]
        self.matrices = [matrix]

    def add(self, time: float, before: float, matrix: NDArray[np.float64]) -> None:
        """Note where it is in a frame; until the frame before it stood where it was noted last."""
        if self.times[-1] < before:
            self.times.append(before)
            self.matrices.append(self.matrices[-1])
        self.times.append(time)
        self.matrices.append(matrix)

    def lower(self, path: str) -> dict[str, Any]:
        """Say it as meshcat does, the numbers in one row."""
        times = np.array(self.times)
        positions = np.array([matrix[12:15] for matrix in self.matrices])
        scales = np.array([_scale(matrix) for matrix in self.matrices])
        quaternions = np.array([_quaternion(matrix) for matrix in self.matrices])
        tracks = [
            {"name": ".position", "type": "vector3", "times": times, "values": positions},
            {"name": ".quaternion", "type": "quaternion", "times": times, "values": quaternions},
        ]
        if np.ptp(scales, axis=0).max() > 1e-6:  # float32: what is rigid has not exactly 1
            tracks.append({"name": ".scale", "type": "vector3", "times": times, "values": scales})
        return {"path": path, "clip": {"fps": 1, "name": "run", "tracks": tracks}}


class _Sight:
    """When something is there to be seen: a body may come and go during a run."""

    def __init__(self, time: float) -> None:
        self.times, self.values = [0.0], [time == 0.0]

    def change(self, time: float, there: bool) -> None:
        if self.values[-1] != there:
            self.times.append(time)
            self.values.append(there)

    def lower(self, path: str) -> dict[str, Any]:
        """Say it as meshcat does."""
        track = {"name": ".visible", "type": "bool", "times": np.array(self.times), "values": self.values}
        return {"path": path, "clip": {"fps": 1, "name": "sight", "tracks": [track]}}


def _quaternion(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """The turn of a matrix, whose 16 numbers are column by column, as three.js has it: (4,), xyzw."""
    quaternion = np.empty(4)
    axes = matrix.reshape(4, 4)[:3, :3] / _scale(matrix)[:, np.newaxis]
    mujoco.mju_mat2Quat(quaternion, axes.T.reshape(9))
    return np.roll(quaternion, -1)


def _scale(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """How long the axes of a matrix are: (3,)."""
    lengths: NDArray[np.float64] = np.linalg.norm(matrix.reshape(4, 4)[:3, :3], axis=1)
    return lengths
