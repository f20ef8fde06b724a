"""The exercise of step N: read from an accelerometer how far the tank leans."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import acos, cos, degrees, hypot, isclose, sin
from typing import Any

from sensor_msgs.msg import Imu

from tutorial.checks._verdict import Finding, right, wrong
from tutorial.checks._watch import watch
from tutorial.checks.exercise import Exercise

__all__ = ["lean"]

GRAVITY = 9.81  # [m/s^2]
CASES = ((0.0, 0.0, GRAVITY), (0.3, 0.0, GRAVITY), (0.3, 1.0, GRAVITY), (0.3, 0.0, 2 * GRAVITY))
"""How far it leans [rad], to which side [rad], and how strong gravity is [m/s^2]."""

IN_DEGREES = "Most likely it is in degrees: ROS 2 uses rad."
ONE_SIDE = "Most likely only one of x and y counts: math.hypot(a.x, a.y, a.z) is the length of all three."
FIXED_GRAVITY = "Most likely gravity is typed in: divide by the length of what was measured."
OTHER = "Compare with the arc cosine of z, divided by the length of the measured acceleration."


def tilt(message: Imu) -> float:
    """Return the angle [rad] between the tank's own up and the world's, for a tank at rest."""
    a = message.linear_acceleration
    return acos(a.z / hypot(a.x, a.y, a.z))


def judge_lean(answer: Callable[[Imu], Any]) -> Iterator[Finding]:
    """Look at an answer to `lean`."""
    for angle, side, gravity in CASES:
        message = Imu()
        a = message.linear_acceleration
        a.x, a.y, a.z = gravity * sin(angle) * cos(side), gravity * sin(angle) * sin(side), gravity * cos(angle)
        with watch.call(answer.__name__):
            given = answer(message)
        text = f"leaning by {angle:g} rad, x, y, z = {a.x:.2f}, {a.y:.2f}, {a.z:.2f}: {given}"
        if isinstance(given, float) and isclose(given, angle, abs_tol=1e-6):
            yield right(text)
            continue
        cause = FIXED_GRAVITY if gravity != GRAVITY else ONE_SIDE if side else OTHER
        yield wrong(text, IN_DEGREES if isinstance(given, float) and isclose(given, degrees(angle)) else cause)
        return


lean = Exercise(
    name="lean",
    statement="""
    Write the function `tilt(message)`. Its message is the `Imu` of a tank at rest, and it returns by how many rad the
    tank leans, to whatever side. Gravity may be that of another planet.
    """,
    judge=judge_lean,
    solution=(tilt,),
    base=None,
    parts=(),
    hints=(
        "Look at the direction of the acceleration: at rest it points up, whichever way the tank leans.",
        "What is asked for is the angle between it and the z axis of the tank.",
        "The cosine of that angle is z, divided by the length of the acceleration: math.hypot gives the length, "
        "math.acos the angle.",
    ),
    notice="Notice that this holds at rest only: a tank that gathers speed measures that, too.",
    imports=("from math import acos, hypot",),
)
