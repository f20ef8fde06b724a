"""The exercise `where`: right answers in various styles, and wrong ones."""

from collections import namedtuple
from functools import reduce

import mujoco
import numpy as np

from tutorial.checks.where import turned, where_is


def to_parent(stamped, point):
    return where_is([stamped], point)


def recursive(transforms, point):
    if not transforms:
        return list(point)
    first, *others = transforms
    t, inner = first.transform.translation, turned(first.transform.rotation, recursive(others, point))
    return (inner[0] + t.x, inner[1] + t.y, inner[2] + t.z)


def by_matrices(transforms, point):
    whole = np.eye(4)
    for stamped in transforms:  # matrices can also be multiplied from the outside in
        q, turn, one = stamped.transform.rotation, np.empty(9), np.eye(4)
        mujoco.mju_quat2Mat(turn, np.array([q.w, q.x, q.y, q.z]))
        one[:3, :3], one[:3, 3] = turn.reshape(3, 3), to_parent(stamped, (0, 0, 0))
        whole = whole @ one
    return (whole @ [*point, 1.0])[:3].tolist()


def named(transforms, point):
    return namedtuple("Place", "x y z")(*reduce(lambda p, t: to_parent(t, p), transforms[::-1], point))


RIGHT = [where_is, recursive, by_matrices, named]


def overwrites(transforms, point):
    p = np.asarray(point, float)
    p[:] = where_is(transforms, p)
    return p


def whole(transforms, point):
    p = np.array(point)
    for stamped in reversed(transforms):
        p += to_parent(stamped, p) - p
    return p


def until_odom(transforms, point):
    for stamped in reversed(transforms):
        point = to_parent(stamped, point)
        if stamped.header.frame_id == "odom":
            break
    return point


def wrong_matrix(transforms, point):
    for stamped in reversed(transforms):
        q = stamped.transform.rotation
        point = to_parent(stamped, point) + np.array([q.x * q.y, 0.0, 0.0])
    return point


WRONG = [
    (lambda transforms, point: to_parent(*transforms, point), "probably expects a certain number of transforms"),
    (lambda all_, point: where_is(all_[:-1], to_parent(all_[-1], point)), "expects at least one transform"),
    (lambda transforms, point: where_is(transforms, point)[:2], "Return the three numbers x, y and z in a list"),
    (overwrites, "Copy the argument first"),
    (whole, "An array made from ints can hold only ints"),
    (until_odom, "or a certain frame"),
    (wrong_matrix, "Rotations about x, y and z work"),
    (lambda transforms, point: to_parent(transforms[-1], point), ["your code uses only the last transform", ""]),
]
