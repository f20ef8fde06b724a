"""The frames of a robot that the view can draw axes for, by the names that they have on `/tf`.

They are the `base_link`, the links that joints move, and the optical frames of the cameras, with the names of the
robot description (`tutorial.description.urdf`).
"""

from collections.abc import Iterator
from typing import NamedTuple

import mujoco
import numpy as np

from tutorial.body import SHOWN_GROUPS
from tutorial.description.poses import OPTICAL, Matrix, pose

ODOM = "odom"
"""The frame that stands still, with the origin of the world."""

FREE = int(mujoco.mjtJoint.mjJNT_FREE)

ROOT = 1
"""MuJoCo's number of a robot's first body, which `base_link` is fixed to."""


class Frame(NamedTuple):
    """A frame that is fixed to a MuJoCo body.

    Attributes:
        name: such as ``"Tank/base_link"``.
        body: MuJoCo's number of the body.
        pose: of the frame in the body, (4, 4) [m].
        label: where the name is written, in lengths of the axes: names of near frames would overlap in one place.
    """

    name: str
    body: int
    pose: Matrix
    label: tuple[float, float, float] = (0.0, 0.0, 1.1)


def frames_of(name: str, model: mujoco.MjModel) -> Iterator[Frame]:
    """Yield the frames of a robot; nothing for a model without joints, such as a room.

    Args:
        name: of the robot, which the names in the model begin with.
        model: the robot's.
    """
    if not model.njnt:
        return
    yield Frame(f"{name}/base_link", ROOT, np.eye(4))
    joints = [model.joint(joint) for joint in np.flatnonzero(model.jnt_group < SHOWN_GROUPS).tolist()]
    names = {joint.name for joint in joints}
    moved = dict.fromkeys(int(joint.bodyid[0]) for joint in joints if joint.type[0] != FREE)
    for i, body in enumerate(moved, 1):
        link = model.body(body).name
        yield Frame(_full(name, f"{link}_link" if link in names else link), body, np.eye(4), (0.0, 0.0, 1.1 + 0.2 * i))
    for camera in map(model.camera, range(model.ncam)):
        optical = pose(camera.pos, camera.quat) @ OPTICAL
        yield Frame(_full(name, f"{camera.name}_optical"), int(camera.bodyid[0]), optical, (0.0, 1.7, 0.0))


def _full(robot: str, name: str) -> str:
    """Put the robot's name before that of a frame. A model that was not composed lacks it."""
    return name if name.startswith(f"{robot}/") else f"{robot}/{name}"
