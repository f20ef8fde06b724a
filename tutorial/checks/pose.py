"""The exercise of step 7: from one frame to the next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from geometry_msgs.msg import Quaternion, TransformStamped
from numpy.typing import ArrayLike, NDArray

from tutorial.checks._where import judge_where
from tutorial.checks.exercise import Exercise

__all__ = ["where"]


def turned(q: Quaternion, point: ArrayLike) -> NDArray[np.float64]:
    """Turn a point about the origin."""
    axis, point = np.array([q.x, q.y, q.z]), np.array(point, float)
    return point + 2 * np.cross(axis, np.cross(axis, point) + q.w * point)


def where_is(transforms: Sequence[TransformStamped], point: ArrayLike) -> ArrayLike:
    """Say where a point of the last frame is, seen from the first."""
    for stamped in reversed(transforms):
        t = stamped.transform.translation
        point = turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z])
    return point


where = Exercise(
    name="where",
    statement="""
    Write the function `where_is(transforms, point)`. It returns x, y and z of a point [m], seen from the outermost
    frame.

    - `transforms` is a list of `TransformStamped`, from the outside to the inside: the parent of the first one is the
      outermost frame, and the child of each is the parent of the next.
    - `point` is x, y, z in the child of the last one. Without transforms it is returned as it is.
    - It works with any number of transforms and with any rotation, and leaves the messages as they are.
    """,
    judge=judge_where,
    solution=(where_is,),
    base=None,
    parts=(),
    hints=(
        "Look at the frame that the point is in: only one of the transforms knows that frame, the last one. What does "
        "it make of the point, and which frame is it in then?",
        "Go through the transforms from the last to the first. Each turns the point by its rotation, with turned, and "
        "then adds its translation; what comes out is given to the one before.",
        "for stamped in reversed(transforms): t = stamped.transform.translation, and point becomes "
        "turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z]). In the end the point is returned.",
    ),
    notice="Notice that nothing asks how many transforms there are: tf2 composes them in just this way.",
)
