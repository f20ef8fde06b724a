"""The exercise `where`: from one frame to the next.

Write the function `where_is(transforms, point)`. It returns x, y and z of a point [m], seen from the outermost frame.

- `transforms` is a list of `TransformStamped`, from the outside to the inside: the parent of the first one is the
  outermost frame, and the child of each is the parent of the next.
- `point` is x, y, z in the child of the last one: a tuple, a list or an array, of whole numbers or others. Without
  transforms, return it as it is.
- It works with any number of transforms and with any rotation, and leaves the list, the messages and the point as
  they are.

Hint 1: Look at the frame that the point is in: only one of the transforms knows that frame, the last one. Where is
the point after this transform, and in which frame?

Hint 2: Go through the transforms from the last to the first. Each turns the point by its rotation, with turned, and
then adds its translation; the transform before it gets the result.

Hint 3: for stamped in reversed(transforms): t = stamped.transform.translation, and point becomes
turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z]). In the end return the point.

Notice that it goes from frame to frame, however many there are: tf2 does just the same.
"""

from collections.abc import Callable, Iterator, Sequence
from math import cos, radians, sin
from typing import Any

import numpy as np
from geometry_msgs.msg import Quaternion, TransformStamped
from numpy.typing import ArrayLike, NDArray

from tutorial.checks.exercise import Cases, Exercise, ask


def turned(q: Quaternion, point: ArrayLike) -> NDArray[np.float64]:
    """Turn a point about the origin."""
    axis, point = np.array([q.x, q.y, q.z]), np.array(point, float)
    return np.asarray(point + 2 * np.cross(axis, np.cross(axis, point) + q.w * point))


def where_is(transforms: Sequence[TransformStamped], point: ArrayLike) -> ArrayLike:
    """Say where a point of the last frame is, seen from the first."""
    for stamped in reversed(transforms):
        t = stamped.transform.translation
        point = turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z])
    return point


MISTAKES = """
the order is the wrong way round: the last transform knows the point's frame, so it comes first.
    reversed( => list(

only the last transform is used, or the first, or one of these is left out: each counts, in reversed(transforms).
    (transforms): => (transforms[-1:]): => (transforms[:1]): => (transforms[:-1]): => (transforms[1:]):

it goes the wrong way, from the parent into the child: turn by the rotation, then add.
    turned(stamped.transform.rotation, point) + np.array( => turned(stamped.transform.rotation, np.array(point) -
    [q.x, q.y, q.z] => [-q.x, -q.y, -q.z]
    reversed( => list( => reversed(

it is turned the wrong way round: x, y, z of the quaternion keep their signs, and a matrix, not transposed, comes first.
    [q.x, q.y, q.z] => [-q.x, -q.y, -q.z]

only the turn about z counts: a frame may be tilted as well.
    axis, point = => q = Quaternion(z=q.z, w=q.w) // axis, point =
    => q = about(UP, atan2(q.w * q.z + q.x * q.y, 0.5 - q.y**2 - q.z**2)) // axis, point =

the translation is added before the turn, and so is turned with it: turn first.
    turned(stamped.transform.rotation, point) + np.array( => turned(stamped.transform.rotation, np.array(point) +

#
Compare with: from the last transform to the first, each turns the point and then adds its whole translation, x, y, z.

# only moved
What is not turned has w = 1 and x, y, z = 0; ROS has w last. Add the whole translation to the point.

# a quarter of a turn to the left
To move is right, and to turn is not: compare with turned(q, point); ROS has x, y, z, w in this order, w last.

# moved, and turned to the left
Each alone, to move and to turn, is right: turn first, and then add.

# its nose up
# rolled to its side
A turn about z is right, and one about another axis is not: compare with turned(q, point).

# about a slanting axis
A turn about x, y or z is right, one about all at once is not: compare with turned().

# quaternions with all signs changed
A rotation has two quaternions, q and -q: the sign of w counts, together with those of x, y, z.

# transforms
Most likely a certain number of transforms is expected, or a frame's name, or rotations are multiplied in the wrong
order, not outer * inner: from the last to the first, each turns what those after it have made of the point, then adds.

# whole numbers
Most likely an array of whole numbers is made, which takes no fractions: begin with np.array(point, float).

# no transform
Without transforms the point is returned as it is: take no first transform for granted, and give it back.
"""
XYZ = "Return x, y and z of the one point: a list, a tuple or an array of three numbers; a message is no list."

Chain = Sequence[tuple[Any, Any, float]]  # of each the translation [m], and axis and angle of the rotation [deg]

FRAMES = ("map", "odom", "Tank/base_link", "turret", "barrel", "tip")
HERE = (0.0, 0.0, 0.0)
UP, LEFT, AHEAD = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
INNER, TILT = ((0.5, 0.0, 0.2), LEFT, -45.0), ((0.5, 0.3, 0.2), LEFT, 290.0)
OUTER = ((1.0, 0.2, 0.0), UP, 20.0), ((-1.0, 0.5, 0.1), UP, 30.0), ((-0.04, 0.0, 0.1), UP, -60.0)
LONG = (*OUTER, ((0.0, 0.1, 0.05), LEFT, -25.0), ((0.4, 0.0, 0.02), (1.0, 1.0, 0.0), 70.0))


def about(axis: Sequence[float], angle: float) -> Quaternion:
    """Make a rotation about an axis of any length, by an angle [rad]."""
    x, y, z = (float(sin(angle / 2) * each / (np.linalg.norm(axis) or 1.0)) for each in axis)
    return Quaternion(x=x, y=y, z=z, w=cos(angle / 2))


def messages(chain: Chain) -> Iterator[TransformStamped]:
    """Make the messages of a chain; five begin in another frame than fewer."""
    frames = FRAMES if len(chain) == 5 else FRAMES[1:]
    for (xyz, axis, angle), parent, child in zip(chain, frames, frames[1:]):
        stamped = TransformStamped(child_frame_id=child)
        stamped.header.frame_id, stamped.transform.rotation = parent, about(axis, radians(angle))
        t = stamped.transform.translation
        t.x, t.y, t.z = xyz
        yield stamped


def tried(chain: Chain, point: Any, kind: Any = tuple) -> Callable[[Any], list[float]]:
    """Observe the numbers that are returned.

    Args:
        chain: the transforms.
        point: in the innermost frame [m].
        kind: what the point is given as.
    """
    return lambda answer: ask(answer, list(messages(chain)), kind(point), read=three, wanted=XYZ)


def three(returned: Any) -> list[float]:
    """Return the three numbers that an answer has returned."""
    x, y, z = map(float, returned)
    return [x, y, z]


TRIED = {
    "a frame that is only moved": tried([((1.0, 2.0, 0.5), UP, 0.0)], (0.3, 0.1, 0.2)),
    "a quarter of a turn to the left": tried([(HERE, UP, 90.0)], (0.3, 0.1, 0.0)),
    "moved, and turned to the left": tried([((2.0, 1.0, 0.1), UP, 90.0)], (0.3, 0.0, 0.2)),
    "its nose up": tried([((0.0, 0.0, 0.1), LEFT, -30.0)], (0.3, 0.0, 0.05)),
    "rolled to its side": tried([((0.5, 0.0, 0.0), AHEAD, 75.0)], (0.1, 0.2, 0.3)),
    "about a slanting axis": tried([((0.25, -1.0, 0.1), (1.0, -2.0, 0.5), 110.0)], (0.3, 0.2, -0.1)),
    "two transforms": tried([((2.0, 1.0, 0.1), UP, 90.0), INNER], (0.3, 0.0, 0.0)),
    "quaternions with all signs changed": tried([((0.5, 0.0, 0.1), UP, 560.0), TILT], (0.1, 0.2, 0.3)),
    "five transforms": tried(LONG, (0.3, 0.1, -0.2)),
    "a point of whole numbers": tried([((0.5, 0.3, 0.2), UP, 30.0)], (3, 1, 2)),
    "a point that is an array": tried(LONG[2:], (0.3, 0.1, -0.2), np.array),
    "no transform": tried([], (1.0, 2.0, 3.0)),
}


def say(numbers: Sequence[float]) -> str:
    """Put a place [m] into words."""
    return ", ".join(f"{number:z.3f}" for number in numbers)


CASES = Cases(where_is, TRIED, MISTAKES, say, crashes=["transform", "whole numbers"], beside=(turned,))
where = Exercise("where", __doc__, CASES)
