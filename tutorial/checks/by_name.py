"""The exercise `by_name`: match a message's positions to the body's joints by name.

Write the function `match_by_name(joint_names, message)`. It returns a new dict that maps the names of the body's joints
to their positions in `message`, a `JointState`. `joint_names` contains the names of the body's joints.

- The i-th position belongs to the i-th name in the message. There can be any number of names, in any order.
- Ignore names that the body does not have.
- If there are fewer or more positions than names, use the names that have a position. If there are no positions, the
  dict is empty.
- Ignore NaN and infinities: `math.isfinite` returns False for them.
- If a name appears twice, use its last finite position.

The function never raises an exception, never makes up a position, and does not change the message.

Hint 1: Look at the message's names and positions as pairs, in the message's order. You can check each pair
independently of the other pairs.

Hint 2: Go through names and positions with zip, which stops at the end of the shorter list. Skip a pair if its name is
not in joint_names or its position is not finite. Put the remaining pairs into a new dict, in order: if a name appears
again, its new position replaces the earlier one.

Hint 3: One dict comprehension is enough: {name: position for name, position in zip(message.name, message.position)
if ...}. The condition is name in joint_names and isfinite(position).

Notice that zip handles a short array, and the dict handles a repeated name: you need no extra code for either.
"""

from collections.abc import Callable, Sequence
from math import inf, isfinite, nan
from numbers import Real
from typing import Any

from sensor_msgs.msg import JointState

from tutorial.checks.engine.cases import Case, Cases, Mistake, replace
from tutorial.checks.engine.failure import Misuse
from tutorial.checks.engine.trial import Trial
from tutorial.checks.exercise import Exercise


def match_by_name(joint_names: Sequence[str], message: JointState) -> dict[str, float]:
    """Match a message's positions to the body's joints."""
    return {
        name: position
        for name, position in zip(message.name, message.position)
        if name in joint_names and isfinite(position)
    }


MISTAKES = [
    Mistake("your code filters the names or the positions before zip pairs them, so the "
            "pairs are wrong. Zip the two lists first, then filter the pairs.",
            replace("message.name, message.position", "[n for n in message.name if n in joint_names], message.position",
                    "message.name, [*filter(isfinite, message.position)]",
                    "message.name, [q for q in message.position if q == q]")),
    Mistake("your code converts the positions. Return them unchanged: messages and bodies both use rad or m.",
            replace("name: position", "name: degrees(position)", "name: radians(position)")),
    Mistake("your code tests only for NaN. An infinity isn't finite either: use math.isfinite.",
            replace("isfinite(position)", "position == position")),
]  # fmt: skip
MEANING = ("Your code probably uses the wrong pairs: use each pair "
           "whose name is in joint_names and whose position is finite.")  # fmt: skip
A_DICT = (
    "Return a dict that maps names to positions; it is empty if no pair is valid. dict(pairs) makes a dict from pairs."
)
KEPT = "Your code probably reuses one dict, such as a default argument, in all calls. Make a new dict in every call."


BODY = ("TURRET_Y", "TURRET_P", "HATCH")
CRANE = ("SLEW", "BRIDGE", "LUFF")
ALMOST = ("turret_y", "Tank/TURRET_P", " HATCH", "TURRET", "", "HATCH_2")
EARLIER = 0.777  # [rad]; every joint's position in an earlier message; it must not appear in the result


def heard(names: Sequence[str], positions: Sequence[float], body: Sequence[str] = BODY) -> Callable[[Trial], str]:
    """Make a case that observes the answer's result for a message, as text.

    Before this message, the answer gets a message with all joints.

    Args:
        names, positions: the message's content; positions in [rad].
        body: the names of the body's joints.
    """

    def case(trial: Trial) -> str:
        kept = list[tuple[dict[Any, Any], list[str]]]()
        for said in (body, [EARLIER] * len(body)), (names, positions):
            message = JointState(name=list(said[0]), position=list(said[1]))
            kept.append(trial.ask(list(body), message, read=lambda found: (found, pairs(found)), wanted=A_DICT))
        (found, before), (_, now) = kept
        if pairs(found) != before:
            raise Misuse("a later call changes the dict that an earlier call returned", KEPT)
        return "{" + ", ".join(now) + "}"

    return case


def pairs(found: dict[Any, Any]) -> list[str]:
    """Format a result, with six significant digits per position."""
    numbers = {name: f"{q + 0.0:.6g}" if isinstance(q, Real) else repr(q) for name, q in found.items()}
    return sorted(f"{name}: {number}" for name, number in numbers.items())


UNKNOWN = ("Your code probably looks up unknown names, or stops at the first unknown name. Skip any pair with an "
           "unknown name, and continue.")  # fmt: skip
EMPTY = "Your code probably expects at least one position. If there are no positions, return {}."
NOT_A_NUMBER = ("Your code probably returns NaN, or lets it affect the other "
                "joints. Skip only the pair with NaN; math.isfinite detects NaN.")  # fmt: skip
TWICE = ("Your code probably uses the wrong position for a repeated name, "
         "or omits the name. Use its last finite position.")  # fmt: skip
CASES = [
    Case("all joints, in order", heard(BODY, (0.1, 0.2, 0.3)),
         "Your code probably doesn't return a dict with all pairs, "
         "{name: position}. Fill one dict, and return it after the loop.", crashes=True),
    Case("joints in a different order", heard(BODY[::-1], (0.3, 0.2, 0.1)),
         "Your code probably expects the joints in the body's order. "
         "Use the message's names to find each position's joint.", crashes=True),
    Case("a message with only HATCH", heard(("HATCH",), (0.3,)),
         "Your code probably expects every joint in every message, or makes up a position for a missing joint. Omit "
         "joints that the message does not name.",
         crashes=True),
    Case("an unknown name, ANTENNA", heard(("ANTENNA", "TURRET_P", "HATCH"), (0.9, 0.2, 0.3)), UNKNOWN, crashes=True),
    Case("3 names, 2 positions", heard(BODY, (0.1, 0.2)),
         "Your code probably expects a position for every name. Use zip: it skips names without a position.",
         crashes=True),
    Case("no positions", heard(BODY, ()), EMPTY, crashes=True),
    Case("NaN for TURRET_P", heard(BODY, (0.1, nan, 0.3)), NOT_A_NUMBER, crashes=True),
    Case("TURRET_Y twice", heard(("TURRET_Y", "TURRET_P", "TURRET_Y"), (0.1, 0.2, 0.3)), TWICE, crashes=True),
    Case("TURRET_Y twice, then smaller", heard(("TURRET_Y", "TURRET_Y", "HATCH"), (0.3, 0.1, 0.2)), TWICE,
         crashes=True),
    Case("TURRET_Y at 0, HATCH below 0", heard(BODY, (0.0, 0.2, -0.3)),
         "Your code probably skips 0, as `if position` does, or negative numbers. Zero and negative numbers are "
         "valid positions.",
         crashes=True),
    Case("an unknown name in the middle", heard(("HATCH", "ANTENNA", "TURRET_Y"), (0.3, 0.9, 0.1)), UNKNOWN,
         crashes=True),
    Case("NaN for HATCH, the last joint", heard(BODY, (0.1, 0.2, nan)), NOT_A_NUMBER, crashes=True),
    Case("TURRET_Y twice, NaN first", heard(("TURRET_Y", "HATCH", "TURRET_Y"), (nan, 0.3, 0.1)), TWICE,
         crashes=True),
    Case("TURRET_Y twice, NaN last", heard(("TURRET_Y", "HATCH", "TURRET_Y"), (0.1, 0.3, nan)), TWICE, crashes=True),
    Case("an empty message", heard((), ()), EMPTY, crashes=True),
    Case("2 names, 3 positions", heard(BODY[:2], (0.1, 0.2, 0.3)),
         "Your code probably expects a name for every position. Use zip: it skips positions without a name.",
         crashes=True),
    Case("names that are almost right", heard(ALMOST, (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)),
         "Your code probably changes names before it compares them, or compares only "
         "parts of them. Use a name only if it equals a joint's name.", crashes=True),
    Case("a position with many digits", heard(BODY, (0.123456, -9.23456, 0.3)),
         "Your code probably converts or rounds positions, or drops their sign. Return them unchanged.", crashes=True),
    Case("a message for the crane", heard(("LUFF", "HATCH", "SLEW"), (0.3, 0.9, 0.1), CRANE),
         "Your code probably hard-codes the tank's joint names. Use joint_names, the names of the body's joints.",
         crashes=True),
    Case("infinity for HATCH", heard(BODY, (0.1, 0.2, inf)),
         "Your code probably tests only for NaN. An infinity isn't finite either: use math.isfinite.", crashes=True),
    Case("a body with one joint", heard(("TURRET_P", "HATCH"), (0.2, 0.3), ("HATCH",)),
         "Your code probably reads only as many names as the body has joints. Go through all names in the message.",
         crashes=True),
]  # fmt: skip

by_name = Exercise(
    "by_name", __doc__, Cases(match_by_name, CASES, MISTAKES, MEANING), imports=("from math import isfinite",)
)
