"""The exercise `where`: transform a point from frame to frame.

Write the function `where_is(transforms, point)`. It returns the point's x, y and z [m] in the outermost frame, as a
list, a tuple or an array of three numbers. The error must be at most 0.1 mm, so don't round.

- `transforms` is a list of `TransformStamped`, from the outermost to the innermost: the parent of the first one is the
  outermost frame, and the child of each is the parent of the next.
- `point` is x, y and z in the child frame of the last transform: a tuple, a list or an array, of ints or floats. If
  `transforms` is empty, return the point unchanged.
- `where_is` works with any number of transforms and any rotation. Don't change the list, the messages or the point.

Hint 1: Which frame is the point in? Only the last transform applies to that frame. Where is the point after this
transform, and which frame is it in then?

Hint 2: Go through the transforms from the last to the first. For each one, turn the point by its rotation, with the
function turned, then add its translation. Apply the previous transform in the list to the result.

Hint 3: for stamped in reversed(transforms): t = stamped.transform.translation; point =
turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z]). After the loop, return the point.

Notice that your function goes from frame to frame, for any number of frames. tf2 does the same.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import reduce
from math import cos, radians, sin
from typing import Any

import numpy as np
from geometry_msgs.msg import Quaternion, TransformStamped
from numpy.typing import ArrayLike, NDArray

from tutorial.checks.engine.cases import Case, Cases, Mistake, both, replace
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise


def turned(q: Quaternion, point: ArrayLike) -> NDArray[np.float64]:
    """Rotate a point about the origin by a unit quaternion."""
    axis, point = np.array([q.x, q.y, q.z]), np.array(point, float)
    return np.asarray(point + 2 * np.cross(axis, np.cross(axis, point) + q.w * point))


def where_is(transforms: Sequence[TransformStamped], point: ArrayLike) -> ArrayLike:
    """Transform a point [m] from the innermost to the outermost frame."""
    for stamped in reversed(transforms):
        t = stamped.transform.translation
        point = turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z])
    return point


MISTAKES = [
    Mistake("your code uses only the last transform or only the first, or skips a transform. Use all transforms.",
            replace("(transforms):", "(transforms[-1:]):", "(transforms[:1]):", "(transforms[:-1]):",
                    "(transforms[1:]):")),
    Mistake("your code applies the transforms from the first to the last. The point is in the last transform's "
            "child frame: go from the last transform to the first.",
            replace("reversed(transforms)", "transforms")),
    Mistake("your code adds the inner translations without turning them. "
            "Each transform also turns the translations of the transforms after it.",
            both(replace("for stamped", "place = np.zeros(3)\nfor stamped"),
                 replace("point = turned(stamped.transform.rotation, point) + np.array([t.x, t.y, t.z])",
                         "point = turned(stamped.transform.rotation, point)\nplace = place + [t.x, t.y, t.z]"),
                 replace("return point", "return place + point"))),
    Mistake("your code multiplies the rotations in the wrong order. "
            "The outer rotation has to be on the left: outer * inner.",
            both(replace("reversed(transforms):", "transforms:"),
                 replace("for stamped", "place, rotations = np.zeros(3), []\nfor stamped"),
                 replace("point = turned(stamped.transform.rotation, point) + np.array(",
                         "place = place + in_order(rotations,"),
                 replace("[t.x, t.y, t.z])", "[t.x, t.y, t.z])\nrotations.append(stamped.transform.rotation)"),
                 replace("return point", "return place + in_order(rotations, point)"))),
    Mistake("your code transforms the point the wrong way, from the parent to the child: "
            "first turn the point by the rotation, then add the translation.",
            both(replace("turned(stamped.transform.rotation, point) + np.array(",
                         "turned(stamped.transform.rotation, np.array(point) -"),
                 replace("[q.x, q.y, q.z]", "[-q.x, -q.y, -q.z]"), replace("reversed(", "list(", "reversed("))),
    Mistake("your code divides by the length of the axis, or by a sine. Both "
            "are 0 if there is no rotation: use turned(q, point).",
            replace("return np.asarray(", "axis = axis if any(axis) else axis * nan\nreturn np.asarray(",
                    "axis = axis if any(axis) else axis * (1 % 0)\nreturn np.asarray(")),
    Mistake("your code rounds the numbers. Rounding to three decimal places "
            "changes each number by up to half a millimetre. Return the unrounded numbers.",
            replace("[t.x, t.y, t.z])", "[t.x, t.y, t.z])\npoint = np.round(point, 3)",
                    "[t.x, t.y, t.z])\npoint = np.round(point, 2)")
            + replace("return point", "return np.round(point, 3)", "return np.round(point, 2)",
                      "return np.round(point, 1)")),
    Mistake("your code returns nothing if the list is empty: in that case, return the point unchanged.",
            replace("return point", "return point if transforms else None")),
]  # fmt: skip
MEANING = ("Compare your steps with these: go from the last transform to the first. "
           "Each one turns the point, and then adds its whole translation, x, y and z.")  # fmt: skip
XYZ = "Return the three numbers x, y and z in a list, a tuple or an array, not in a message such as Point."

Chain = Sequence[tuple[Any, Any, float]]  # translation [m], axis and angle of the rotation [deg]

FRAMES = ("map", "odom", "Tank/base_link", "turret", "barrel", "tip")
HERE = (0.0, 0.0, 0.0)
UP, LEFT, AHEAD = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
INNER, TILT = ((0.5, 0.0, 0.2), LEFT, -45.0), ((0.5, 0.3, 0.2), LEFT, 290.0)
OUTER = ((1.0, 0.2, 0.0), UP, 20.0), ((-1.0, 0.5, 0.1), UP, 30.0), ((-0.04, 0.0, 0.1), UP, -60.0)
LONG = (*OUTER, ((0.0, 0.1, 0.05), LEFT, -25.0), ((0.4, 0.0, 0.02), (1.0, 1.0, 0.0), 70.0))


def about(axis: Sequence[float], angle: float) -> Quaternion:
    """Return the rotation by an angle [rad] about an axis of any length."""
    x, y, z = (float(sin(angle / 2) * each / (np.linalg.norm(axis) or 1.0)) for each in axis)
    return Quaternion(x=x, y=y, z=z, w=cos(angle / 2))


def in_order(rotations: Sequence[Quaternion], point: ArrayLike) -> ArrayLike:
    """Turn a point by all rotations in the wrong order, from the first to the last."""
    return reduce(lambda turning, q: turned(q, turning), rotations, point)


def messages(chain: Chain) -> Iterator[TransformStamped]:
    """Make the messages of a chain. The outermost frame of five transforms is map; that of a shorter chain is odom."""
    frames = FRAMES if len(chain) == 5 else FRAMES[1:]
    for (xyz, axis, angle), parent, child in zip(chain, frames, frames[1:]):
        stamped = TransformStamped(child_frame_id=child)
        stamped.header.frame_id, stamped.transform.rotation = parent, about(axis, radians(angle))
        t = stamped.transform.translation
        t.x, t.y, t.z = xyz
        yield stamped


def tried(chain: Chain, point: Any, kind: Any = tuple) -> Callable[[Trial], list[float]]:
    """Make a case that observes the returned numbers.

    Args:
        chain: the transforms.
        point: a point in the innermost frame [m].
        kind: the type of the point that the answer gets.
    """
    return lambda trial: trial.ask(list(messages(chain)), kind(point), read=three, wanted=XYZ)


def three(returned: Any) -> list[float]:
    """Return the three numbers of an answer's point as floats."""
    x, y, z = map(float, returned)
    return [x, y, z]


ABOUT_Y = ("A rotation about z works, but one about a different axis doesn't. The mistake "
           "is probably in the terms with x and y: compare your code with turned(q, point).")  # fmt: skip
IN_TURN = ("Your code probably expects a certain number of transforms, or a certain frame. "
           "Go from the last transform to the first, however many there are: each one turns the result of the "
           "transform after it, and then adds its own translation.")  # fmt: skip
CASES = [
    Case("a frame that is only translated", tried([((1.0, 2.0, 0.5), UP, 0.0)], (0.3, 0.1, 0.2)),
         "There is no rotation here: x, y and z of the quaternion are 0 and w is 1. Your code probably reads "
         "w from the wrong place (in ROS it is last), adds only part of the translation, or looks for a "
         "certain frame."),
    Case("a quarter turn to the left", tried([(HERE, UP, 90.0)], (0.3, 0.1, 0.0)),
         "The mistake is probably in the rotation itself: compare your code "
         "with turned(q, point). ROS uses the order x, y, z, w."),
    Case("translated, and turned to the left", tried([((2.0, 1.0, 0.1), UP, 90.0)], (0.3, 0.0, 0.2)),
         "A translation alone works, and so does a rotation alone. Your code probably "
         "combines them in the wrong order: first turn the point, then add the translation."),
    Case("turned about y, nose up", tried([((0.0, 0.0, 0.1), LEFT, -30.0)], (0.3, 0.0, 0.05)), ABOUT_Y),
    Case("turned about x, on its side", tried([((0.5, 0.0, 0.0), AHEAD, 75.0)], (0.1, 0.2, 0.3)), ABOUT_Y),
    Case("turned about an oblique axis", tried([((0.25, -1.0, 0.1), (1.0, -2.0, 0.5), 110.0)], (0.3, 0.2, -0.1)),
         "Rotations about x, y and z work. Your code probably combines "
         "the three incorrectly: compare your code with turned(q, point)."),
    Case("two transforms", tried([((2.0, 1.0, 0.1), UP, 90.0), INNER], (0.3, 0.0, 0.0)), IN_TURN, crashes=True),
    Case("quaternions with all signs flipped", tried([((0.5, 0.0, 0.1), UP, 560.0), TILT], (0.1, 0.2, 0.3)),
         "q and -q represent the same rotation. "
         "Your code probably uses the sign of w, but not those of x, y and z."),
    Case("five transforms", tried(LONG, (0.3, 0.1, -0.2)), IN_TURN, crashes=True),
    Case("a point of ints", tried([((0.5, 0.3, 0.2), UP, 30.0)], (3, 1, 2)),
         "An array made from ints can hold only ints. Your code probably drops "
         "the fractional parts: start with np.array(point, float).", crashes=True),
    Case("a point that is an array", tried(LONG[2:], (0.3, 0.1, -0.2), np.array)),
    Case("no transform", tried([], (1.0, 2.0, 3.0)),
         "Your code probably expects at least one transform. If the list is empty, return the point unchanged.",
         crashes=True),
]  # fmt: skip


def describe(numbers: Sequence[float]) -> str:
    """Format a position [m] with at most four decimals, so that differences and rounding are visible."""
    return ", ".join(f"{round(number, 4):zg}" for number in numbers)


where = Exercise("where", __doc__, Cases(where_is, CASES, MISTAKES, MEANING, describe, beside=(turned,)))
