"""Roll, pitch and yaw: any rotation can be restored from them."""

from math import pi, tau

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tutorial.description.poses import numbers, pose, roll_pitch_yaw

angles = st.floats(-tau, tau)
STRAIGHT_UP = [sign * (pi / 2 + off) for sign in (-1, 1) for off in (0.0, 1e-12, -1e-9, 3e-9, -1e-6)]


def turned(*angles):
    """Return the rotation by roll, pitch and yaw about fixed axes, as MuJoCo computes it."""
    quaternion = np.empty(4)
    mujoco.mju_euler2Quat(quaternion, angles, "XYZ")
    return pose((0, 0, 0), quaternion)[:3, :3]


@given(roll=angles, pitch=angles | st.sampled_from(STRAIGHT_UP), yaw=angles)
def test_the_angles_restore_the_rotation(roll, pitch, yaw):
    rotation = turned(roll, pitch, yaw)
    np.testing.assert_allclose(turned(*roll_pitch_yaw(rotation)), rotation, atol=2e-9)


@pytest.mark.parametrize(
    ("values", "text"),
    [([0.0, -0.0, 1e-17], "0 0 0"), ([1 / 3, -2.0], "0.333333333333 -2"), (np.full(1, 1e9), "1000000000")],
)
def test_numbers_have_twelve_digits_and_no_rounding_noise(values, text):
    assert numbers(values) == text
