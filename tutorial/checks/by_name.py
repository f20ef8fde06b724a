"""The exercise `by_name`: find out which joint a message moves where.

Write the function `match_by_name(joint_names, message)`. It returns a dict from joint names to positions: what the
`JointState` `message` says about the joints of the body, whose names are in `joint_names`.

- The i-th position belongs to the i-th name of the message, in whatever order, and however many there are.
- Leave out names that the body does not have.
- If there are fewer positions than names, use those that are there; if there are none, the dict is empty.
- Leave out a position for which `math.isfinite` says no: NaN, or an infinity.
- If a name comes twice, the last finite number counts.

It never raises, never invents a number, and leaves the message as it is.

Hint 1: Look at the message's names and positions as pairs, in the message's order: each pair either counts or not,
and none says anything about another.

Hint 2: Go through both together with zip, which ends with the shorter. Leave out a pair whose name is not in
joint_names, or whose position is not finite. Put the others into a new dict, one after the other: of equal names the
last wins by itself.

Hint 3: One dict comprehension does it all: {name: position for name, position in zip(message.name, message.position)
if ...}, with name in joint_names and isfinite(position).

Notice that a short array, an unknown name and a name that comes twice needed no line of their own.
"""

from collections.abc import Callable, Sequence
from math import inf, isfinite, nan
from numbers import Real
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.checks.exercise import Cases, Exercise, Misuse, ask


def match_by_name(joint_names: Sequence[str], message: JointState) -> dict[str, float]:
    """Find out which joint a message moves where."""
    return {
        name: position
        for name, position in zip(message.name, message.position)
        if name in joint_names and isfinite(position)
    }


MISTAKES = """
unknown names or NaN are left out before zip, so positions move to other names: zip both as they come, leave out pairs.
    message.name, message.position => [n for n in message.name if n in joint_names], message.position
    => message.name, [*filter(isfinite, message.position)] => message.name, [q for q in message.position if q == q]

#
Compare with: the i-th position belongs to the i-th name, if the body has that name and it is finite.

# all joints, in order
Return a dict from names to positions, {name: position}, with all pairs: return comes behind the loop.

# another order
Most likely the order of the body is expected in the message: go by the message's names, wherever each stands.

# only HATCH
Most likely every joint is expected in every message: a joint without a name in it is left out, and not given a number.

# an unknown name
Most likely an unknown name is kept, or spoils the others: leave out a pair whose name is not in joint_names, and go on.

# 3 names
Most likely a name without a position is given one, or spoils the message: zip leaves out that name, the others count.

# 2 names
Most likely more positions than names are not expected: those without a name say nothing.

# no positions
# an empty message
Most likely an empty array is not expected: it says nothing about the pose, so return {}.

# NaN for
Most likely NaN is not left out, or spoils the message: only that joint is left out, and math.isfinite tells.

# infinity
Most likely infinity is not left out, as NaN is: ask math.isfinite, isnan does not tell.

# twice
Most likely the wrong one counts of a name that comes twice, or none: the last one that is a number does.

# almost right
Most likely names are compared in part, or changed first: a joint's name is the whole of it.

# HATCH below
Most likely 0.0 is taken for nothing, as in `if position`, or what is below 0: both are positions.

# many digits
Most likely positions are converted, rounded or lose their sign: they are rad on both sides, pass them on as they are.

# the crane
Most likely the joints' names are typed: those of the body are in joint_names.

# one joint
Most likely only as many names are looked at as the body has joints: look at all of the message's.
"""
A_DICT = "Return a dict from names to positions, an empty one when there is nothing to tell; dict(pairs) makes one."
KEPT = "Most likely the dict is kept from call to call: make a new one in every call, and not as a default argument."


BODY = ("TURRET_Y", "TURRET_P", "HATCH")
CRANE = ("SLEW", "BRIDGE", "LUFF")
ALMOST = ("turret_y", "Tank/TURRET_P", " HATCH", "TURRET", "", "HATCH_2")
EARLIER = 0.777  # [rad], where all joints are in the message that comes before the one that is looked at


def heard(names: Sequence[str], positions: Sequence[float], body: Sequence[str] = BODY) -> Callable[[Any], str]:
    """Make a case of a message: what is returned for it, as a text, after another one which names all joints.

    Args:
        names, positions: what the message says [rad].
        body: the names of the body's joints.
    """

    def case(answer: Any) -> str:
        kept = list[tuple[dict[Any, Any], list[str]]]()
        for said in (body, [EARLIER] * len(body)), (names, positions):
            message = JointState(name=list(said[0]), position=list(said[1]))
            kept.append(ask(answer, list(body), message, read=lambda found: (found, pairs(found)), wanted=A_DICT))
        (found, before), (_, told) = kept
        if pairs(found) != before:
            raise Misuse("what it has returned before is not the same afterwards", KEPT)
        return "{" + ", ".join(told) + "}"

    return case


def pairs(found: dict[Any, Any]) -> list[str]:
    """Put what was returned into words, positions to six digits."""
    numbers = {name: f"{q + 0.0:.6g}" if isinstance(q, Real) else repr(q) for name, q in found.items()}
    return sorted(f"{name}: {number}" for name, number in numbers.items())


TRIED = {
    "all joints, in order": heard(BODY, (0.1, 0.2, 0.3)),
    "another order": heard(BODY[::-1], (0.3, 0.2, 0.1)),
    "only HATCH": heard(("HATCH",), (0.3,)),
    "an unknown name, ANTENNA": heard(("ANTENNA", "TURRET_P", "HATCH"), (0.9, 0.2, 0.3)),
    "3 names, 2 positions": heard(BODY, (0.1, 0.2)),
    "no positions": heard(BODY, ()),
    "NaN for TURRET_P": heard(BODY, (0.1, nan, 0.3)),
    "TURRET_Y twice": heard(("TURRET_Y", "TURRET_P", "TURRET_Y"), (0.1, 0.2, 0.3)),
    "TURRET_Y twice, and smaller": heard(("TURRET_Y", "TURRET_Y", "HATCH"), (0.3, 0.1, 0.2)),
    "TURRET_Y at 0, HATCH below": heard(BODY, (0.0, 0.2, -0.3)),
    "an unknown name in the middle": heard(("HATCH", "ANTENNA", "TURRET_Y"), (0.3, 0.9, 0.1)),
    "NaN for HATCH, the last": heard(BODY, (0.1, 0.2, nan)),
    "TURRET_Y twice, at first NaN": heard(("TURRET_Y", "HATCH", "TURRET_Y"), (nan, 0.3, 0.1)),
    "TURRET_Y twice, at last NaN": heard(("TURRET_Y", "HATCH", "TURRET_Y"), (0.1, 0.3, nan)),
    "an empty message": heard((), ()),
    "2 names, 3 positions": heard(BODY[:2], (0.1, 0.2, 0.3)),
    "names that are almost right": heard(ALMOST, (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)),
    "a position with many digits": heard(BODY, (0.123456, -9.23456, 0.3)),
    "the crane's joints": heard(("LUFF", "HATCH", "SLEW"), (0.3, 0.9, 0.1), CRANE),
    "infinity for HATCH": heard(BODY, (0.1, 0.2, inf)),
    "a body with one joint": heard(("TURRET_P", "HATCH"), (0.2, 0.3), ("HATCH",)),
}

CASES = Cases(match_by_name, TRIED, MISTAKES, str, crashes=[""])
by_name = Exercise("by_name", __doc__, CASES, imports=("from math import isfinite",))
