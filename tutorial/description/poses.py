"""Poses as 4 x 4 matrices, and in URDF's notation: position, and roll, pitch and yaw."""

from collections.abc import Iterable
from math import atan2, cos, hypot, pi, sin
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

Matrix = NDArray[np.floating[Any]]

NOTHING = 1e-12
"""Smaller numbers [m] or [rad] are rounding errors, and are written as 0."""
GIMBAL_LOCK = 1e-9
"""If the cosine of the pitch is smaller than this, roll and yaw turn about the same axis, and yaw is set to 0."""


def pose(position: ArrayLike, orientation_wxyz: ArrayLike) -> Matrix:
    """Make a pose from a position (3,) [m] and a unit quaternion (4,) in MuJoCo's order, with w first."""
    rotation = np.empty(9)
    mujoco.mju_quat2Mat(rotation, np.asarray(orientation_wxyz, dtype=float))
    matrix = np.eye(4)
    matrix[:3, :3] = rotation.reshape(3, 3)
    matrix[:3, 3] = position
    return matrix


def shift(by: ArrayLike) -> Matrix:
    """Make a pose from a translation (3,) [m]."""
    return pose(by, (1.0, 0.0, 0.0, 0.0))


def turn(axis: ArrayLike, angle: float) -> Matrix:
    """Make a pose from a rotation by an angle [rad] about an axis (3,) through the origin."""
    quaternion = np.empty(4)
    mujoco.mju_axisAngle2Quat(quaternion, np.asarray(axis, dtype=float), angle)
    return pose((0.0, 0.0, 0.0), quaternion)


OPTICAL = turn((1.0, 0.0, 0.0), pi)
"""The rotation from MuJoCo's camera frame (z back, y up) to an optical frame (z forward, y down; REP 103)."""


def roll_pitch_yaw(rotation: Matrix) -> tuple[float, float, float]:
    """Return the angles [rad] of a rotation (3, 3) about the fixed axes x, y and z, applied in this order."""
    (r00, r01, r02), (r10, r11, r12), (r20, _, _) = rotation[:, :3].tolist()
    yaw = 0.0 if hypot(r00, r10) < GIMBAL_LOCK else atan2(r10, r00)
    cosine, sine = cos(yaw), sin(yaw)  # yaw is undone below, so roll and pitch compensate for its rounding errors
    roll = atan2(sine * r02 - cosine * r12, cosine * r11 - sine * r01)
    return roll, atan2(-r20, cosine * r00 + sine * r10), yaw


def add_origin(parent: Element, matrix: Matrix) -> None:
    """Write a pose as an ``<origin>``. An element without an ``<origin>`` is at its parent's origin."""
    if np.abs(matrix - np.eye(4)).max() > NOTHING:
        angles = roll_pitch_yaw(matrix[:3, :3])
        SubElement(parent, "origin", xyz=numbers(matrix[:3, 3]), rpy=numbers(angles))


def numbers(values: Iterable[float]) -> str:
    """Format numbers with twelve digits, separated by spaces. At robot scale, this is finer than a micrometre."""
    return " ".join("0" if abs(value) < NOTHING else f"{value:.12g}" for value in values)
