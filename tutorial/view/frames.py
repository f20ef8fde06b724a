"""The robot frames whose axes the view can draw, with the same names as on `/tf`.

They are `base_link`, the links moved by joints, and the optical frames of the cameras. Their names are those in the
robot description (`tutorial.description.urdf`).
"""

from collections.abc import Iterator
from typing import NamedTuple

import mujoco
import numpy as np

from tutorial.body import SHOWN_GROUPS
from tutorial.description.poses import OPTICAL, Matrix, pose

ODOM = "odom"
"""The stationary frame at the origin of the world."""

FREE = int(mujoco.mjtJoint.mjJNT_FREE)

ROOT = 1
"""The MuJoCo ID of a robot's first body, which `base_link` is fixed to."""


class Frame(NamedTuple):
    """A frame that is fixed to a MuJoCo body.

    Attributes:
        name: the frame's name, such as ``"Tank/base_link"``.
        body: the MuJoCo ID of the body.
        pose: the frame's pose relative to the body, (4, 4) [m].
        label: the position of the name, in units of the axes' length, chosen so that the names of nearby frames don't
            overlap.
    """

    name: str
    body: int
    pose: Matrix
    label: tuple[float, float, float] = (0.0, 0.0, 1.1)


def frames_of(name: str, model: mujoco.MjModel) -> Iterator[Frame]:
    """Yield the frames of a robot; nothing for a model without joints, such as a room.

    Args:
        name: the robot's name, which is the prefix of the names in the model.
        model: the robot's model.
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
    """Return a frame's name with the robot's name as a prefix. Names in a composed model already have this prefix."""
    return name if name.startswith(f"{robot}/") else f"{robot}/{name}"
