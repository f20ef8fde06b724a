"""Turns the messages that a scene sends during a run into one message with all objects and their animation.

In meshcat, an animation contains the poses of each object that moves, and the time of each pose.
"""

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from tutorial.view.scene import Record, Scene, unpack_command, unpack_records


class Animation:
    """Collects the objects that a scene has shown, and when they moved, appeared and disappeared.

    Attributes:
        lines: the lines below the view: (start time [s], text).
    """

    def __init__(self) -> None:
        self.lines: list[tuple[float, str]] = []
        self._scene = Scene()
        self._poses: dict[str, _Track] = {}
        self._sights: dict[str, _Track] = {}
        self._before = self._now = 0.0
        self._has_camera = False

    def add(self, time: float, message: bytes) -> None:
        """Add a message from the scene, with its time in the run [s]. An empty message means that nothing changed."""
        self._before, self._now = self._now, time
        for kind, payload in unpack_records(message):
            if kind is Record.COMMAND:
                self._take(unpack_command(payload))
            elif kind is Record.LINE:
                self.lines.append((round(time, 3), payload.decode()))
            elif kind is Record.CAMERA and not self._has_camera:  # a replay begins at the first camera position
                self._has_camera = True
                numbers = np.frombuffer(payload, "<f8").tolist()
                self._scene.look_at(tuple(numbers[:3]), tuple(numbers[3:]))

    def finish(self) -> bytes:
        """Return one message with all objects that were ever shown, and their animation."""
        clips = [_clip(path, "run", _motion(track)) for path, track in self._poses.items() if len(track.times) > 1]
        clips += [
            _clip(path, "sight", [_keys(".visible", "bool", track, track.values)])
            for path, track in self._sights.items()
            if len(track.times) > 1
        ]
        self._scene.send_message({"type": "set_animation", "path": "", "animations": clips, "options": {"play": False}})
        return self._scene.snapshot()

    def _take(self, command: dict[str, Any]) -> None:
        path = command["path"]
        match command["type"]:
            case "delete":
                for drawn in self._sights:
                    if f"{drawn}/".startswith(f"{path}/"):
                        self._see(drawn, False)
            case "set_transform":
                self._move(command)
            case "set_object":
                self._see(path, True)
                self._scene.send_message(command)
            case "set_property" if command["property"] == "color" and path.startswith("/Bodies/"):
                pass  # a joint that is stale at the end was not always stale; the line below the view shows when it was
            case _:
                self._scene.send_message(command)

    def _see(self, path: str, there: bool) -> None:
        """Record when an object appears or disappears: bodies can be added and removed during a run."""
        track = self._sights.setdefault(path, _Track([0.0], [self._now == 0.0]))
        if track.values[-1] != there:
            track.add(self._now, there)

    def _move(self, command: dict[str, Any]) -> None:
        """Record an object's pose. Poses are interpolated, so a pause needs a pose at its start and at its end."""
        matrix = np.array(command["matrix"], dtype=np.float64)
        if not np.isfinite(matrix).all():
            return
        if track := self._poses.get(command["path"]):
            if track.times[-1] < self._before:
                track.add(self._before, track.values[-1])
            track.add(self._now, matrix)
        else:
            self._poses[command["path"]] = _Track([self._now], [matrix])
            self._scene.send_message(command)


@dataclass
class _Track:
    """One object's poses or visibility: times [s], and the value at each time."""

    times: list[float]
    values: list[Any]

    def add(self, time: float, value: object) -> None:
        self.times.append(time)
        self.values.append(value)


def _motion(track: _Track) -> list[dict[str, Any]]:
    """Convert poses to meshcat tracks. Matrices are stored column by column, and three.js orders quaternions xyzw."""
    columns = np.array(track.values).reshape(-1, 4, 4)
    scales = np.linalg.norm(columns[:, :3, :3], axis=2)
    quaternions = np.empty((len(columns), 4))
    for quaternion, axes in zip(quaternions, columns[:, :3, :3] / scales[:, :, np.newaxis]):
        mujoco.mju_mat2Quat(quaternion, axes.T.ravel())
    motion = [
        _keys(".position", "vector3", track, columns[:, 3, :3]),
        _keys(".quaternion", "quaternion", track, np.roll(quaternions, -1, axis=1)),
    ]
    if np.ptp(scales, axis=0).max() > 1e-6:  # in float32, a rigid motion's scale is not exactly 1
        motion.append(_keys(".scale", "vector3", track, scales))
    return motion


def _keys(name: str, kind: str, track: _Track, values: object) -> dict[str, Any]:
    return {"name": name, "type": kind, "times": np.array(track.times), "values": values}


def _clip(path: str, name: str, tracks: list[dict[str, Any]]) -> dict[str, Any]:
    return {"path": path, "clip": {"fps": 1, "name": name, "tracks": tracks}}
