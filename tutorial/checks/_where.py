"""Looking at an answer to `where`: points in frames that are moved, turned, and nested."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from math import radians
from typing import Any

import mujoco
import numpy as np
from geometry_msgs.msg import TransformStamped
from numpy.typing import NDArray

from tutorial.checks._answer import name_of
from tutorial.checks._diagnose import Misuse
from tutorial.checks._explain import Mistake, Probe, judge_probes
from tutorial.checks._shared import SharedState
from tutorial.checks._verdict import Finding, judged, wrong
from tutorial.checks._watch import Failure, watch

__all__ = ["judge_where"]

Vector = tuple[float, float, float]

SHOWN = 9  # numbers of an answer that are looked at

COMPARE = "Compare with: from the last transform to the first, each turns the point and then adds its translation."
NO_RETURN = "Most likely return is missing: give the point back."
NOT_THREE = "Return x, y and z: a list, a tuple or an array of three numbers."
FIELDS = "Return the three numbers themselves, [p.x, p.y, p.z]: a message is no list."
CHANGED = "Most likely an assignment, pop or reverse changes what was given: leave it as it is; reversed() copies."
NONE_GIVEN = "Most likely a first transform is taken for granted: with none the point is returned as it is."
HOW_MANY = "Most likely a certain number of transforms is expected: go through all of them, in a loop."
ORDER = "Most likely the order is the wrong way round: the last transform knows the point's frame, so it comes first."


@dataclass(frozen=True)
class _Case:
    """One chain of transforms.

    Attributes:
        label: what it is like.
        chain: of each transform the translation [m], and the axis and the angle of its rotation [deg].
        point: in the innermost frame [m].
        crash: the most likely cause when something is raised.
        sign: -1 for quaternions that are the negative of the usual ones.
    """

    label: str
    chain: Sequence[tuple[Vector, Vector, float]]
    point: Vector
    crash: str = ""
    sign: float = 1.0

    def quaternions_wxyz(self) -> list[NDArray[np.float64]]:
        """Return the rotations."""
        found = []
        for _, axis, angle in self.chain:
            quaternion = np.empty(4)
            mujoco.mju_axisAngle2Quat(quaternion, np.array(axis) / np.linalg.norm(axis), radians(angle))
            found.append(self.sign * quaternion)
        return found

    def transforms(self) -> list[TransformStamped]:
        """Make the messages."""
        made = []
        for i, ((place, _, _), wxyz) in enumerate(zip(self.chain, self.quaternions_wxyz())):
            stamped = TransformStamped(child_frame_id=FRAMES[i + 1])
            stamped.header.frame_id = FRAMES[i]
            t, q = stamped.transform.translation, stamped.transform.rotation
            t.x, t.y, t.z = place
            q.w, q.x, q.y, q.z = wxyz.tolist()
            made.append(stamped)
        return made


FRAMES = ("odom", "Tank/base_link", "turret", "barrel")
UP, LEFT, AHEAD = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)
HERE = (0.0, 0.0, 0.0)

CASES = (
    _Case("a frame that is only moved", [((1.0, 2.0, 0.5), UP, 0.0)], (0.3, 0.1, 0.2)),
    _Case("a quarter of a turn to the left", [(HERE, UP, 90.0)], (0.3, 0.1, 0.0)),
    _Case("moved, and turned to the left", [((2.0, 1.0, 0.1), UP, 90.0)], (0.3, 0.0, 0.2)),
    _Case("its nose up", [((0.0, 0.0, 0.1), LEFT, -30.0)], (0.3, 0.0, 0.05)),
    _Case("rolled to its side", [((0.5, 0.0, 0.0), AHEAD, 75.0)], (0.1, 0.2, 0.3)),
    _Case("about a slanting axis", [((0.25, -1.0, 0.1), (1.0, -2.0, 0.5), 110.0)], (0.3, 0.2, -0.1)),
    _Case("two transforms", [((2.0, 1.0, 0.1), UP, 90.0), ((0.5, 0.0, 0.2), UP, -45.0)], (0.3, 0.0, 0.0), HOW_MANY),
    _Case(
        "three transforms",
        [((-1.0, 0.5, 0.1), UP, 30.0), ((-0.04, 0.0, 0.1), UP, -60.0), ((0.0, 0.1, 0.05), LEFT, -25.0)],
        (0.3, 0.0, 0.0),
        HOW_MANY,
    ),
    _Case(
        "the innermost origin",
        [((2.0, 1.0, 0.1), UP, 120.0), ((0.5, 0.3, 0.2), AHEAD, 40.0)],
        (0.0, 0.0, 0.0),
        HOW_MANY,
    ),
    _Case(
        "quaternions with all signs changed",
        [((0.5, 0.0, 0.1), UP, 200.0), ((0.5, 0.3, 0.2), LEFT, -70.0)],
        (0.1, 0.2, 0.3),
        HOW_MANY,
        sign=-1.0,
    ),
    _Case("no transform", [], (1.0, 2.0, 3.0), NONE_GIVEN),
)

MISTAKES = (
    Mistake("order", "outer first", ORDER.removeprefix("Most likely ")),
    Mistake("order", "last", "only the last transform is used: each of them counts."),
    Mistake("order", "first", "only the first transform is used: each of them counts."),
    Mistake("order", "but the last", "the last transform is left out: reversed(transforms) has all of them."),
    Mistake("order", "but the first", "the first transform is left out: reversed(transforms) has all of them."),
    Mistake("way", "back", "it goes the wrong way, from the parent into the child: turn by the rotation, then add."),
    Mistake("turn", "not", "the rotation is left out: turned(stamped.transform.rotation, point)."),
    Mistake("turn", "back", "it is turned the wrong way round: x, y, z of the quaternion stay as they are."),
    Mistake("turn", "w first", "x is taken for w: in ROS the order is x, y, z, w, and only MuJoCo has w first."),
    Mistake("turn", "z, y, x, w", "the axis is in reverse order: it is x, y, z."),
    Mistake("turn", "flat", "only the turn about z counts: a frame may be tilted as well."),
    Mistake("turn", "half", "the 2 is missing: a point moves by twice the cross product."),
    Mistake("turn", "translation alone", "the translation is turned, and the point is not: the point is turned."),
    Mistake("turn", "angle", "w is taken for the angle: it is the cosine of its half."),
    Mistake("add", "before", "the translation is added before the turn, and so is turned with it: turn first."),
    Mistake("add", "not", "the translation is left out: add it after the turn."),
    Mistake("add", "minus", "the translation is taken off: it says where the child is in the parent, so add it."),
    Mistake("add", "flat", "only x and y of the translation are added: z, too."),
    Mistake("add", "twice", "the translation is added twice."),
    Mistake("add", "of the first", "the translations are not added of all: each transform has its own."),
    Mistake("add", "of the last", "the translation of the last transform alone is added: each has its own."),
    Mistake("add", "unturned", "the translations are added up, and not turned by the frames that they are in."),
    Mistake("point", "not", "the point itself is left out, and where its frame begins is returned."),
    Mistake("point", "unturned", "the point is added at the end: it has to be turned by each rotation."),
    Mistake("point", "flat", "z of the point is left out."),
    Mistake("result", "rounded", "the result is rounded: return it as it is."),
    Mistake("result", "reversed", "z, y, x is returned: the order is x, y, z."),
)


def judge_where(answer: Callable[[list[TransformStamped], Vector], Any]) -> Iterator[Finding]:
    """Look at an answer to `where`."""
    shared = SharedState(answer)
    probes: list[Probe] = []
    odd = None
    for case in CASES:
        transforms = case.transforms()
        try:
            with watch.call(name_of(answer)):
                returned = answer(transforms, case.point)
        except Failure as failure:
            known = isinstance(failure.error, (LookupError, TypeError, ValueError, AttributeError)) and case.crash
            odd = failure.finding(case.crash if known and not isinstance(failure.error, Misuse) else None, case.label)
            break
        odd = _judge_kind(answer, case.label, returned)
        if odd is None and transforms != case.transforms():
            odd = wrong(f"{case.label}: the transforms are not the same afterwards", CHANGED)
        if odd is not None:
            break
        probes.append(Probe(case.label, _numbers(returned), _say))
    yield from judged(judge_probes(probes, predict, MISTAKES, shared.cause(COMPARE)))
    if odd is not None:
        yield odd


def _judge_kind(answer: Any, label: str, returned: Any) -> Finding | None:
    """Look whether something else is returned than three numbers."""
    if returned is None:
        return wrong(f"{label}: {name_of(answer)} returns None", NO_RETURN)
    text = f"{label}: {name_of(answer)} returns a {type(returned).__name__}"
    try:
        numbers = _numbers(returned)
    except (TypeError, ValueError):
        fields = all(hasattr(returned, name) for name in "xyz") or hasattr(returned, "point")
        return wrong(text, FIELDS if fields else NOT_THREE)
    if isinstance(returned, (str, bytes, dict, set)) or len(numbers) != 3:
        return wrong(f"{text} of {len(numbers)}", NOT_THREE)
    return None


def _numbers(returned: Any) -> tuple[float, ...]:
    return tuple(float(each) for each in islice(returned, SHOWN))


def predict(
    order: str = "", way: str = "", turn: str = "", add: str = "", point: str = "", result: str = ""
) -> Iterator[tuple[float, ...]]:
    """Yield what an answer with such mistakes returns for each case; without any, it is the right one."""
    for case in CASES:
        moves = [np.array(place) for place, _, _ in case.chain]
        steps = list(zip(moves, case.quaternions_wxyz()))
        chosen = {
            "outer first": steps[::-1],
            "last": steps[-1:],
            "first": steps[:1],
            "but the last": steps[:-1],
            "but the first": steps[1:],
        }
        steps = chosen.get(order, steps)
        given = np.array(case.point)
        seen = given * {"not": 0.0, "unturned": 0.0}.get(point, 1.0)
        seen[2] *= point != "flat"
        for i in reversed(range(len(steps))):
            seen = _one_step(seen, *steps[i], way, turn, _added(add, i, len(steps)))
        if add == "unturned":
            seen = seen + sum((place for place, _ in steps), np.zeros(3))
        if point == "unturned":
            seen = seen + given
        if result == "rounded":
            seen = np.round(seen, 2)
        yield tuple((seen[::-1] if result == "reversed" else seen).tolist())


def _added(add: str, i: int, count: int) -> str:
    """What the i-th step does with its translation."""
    if (add == "of the first" and i > 0) or (add == "of the last" and i < count - 1):
        return "not"
    return "not" if add == "unturned" else "" if add.startswith("of") else add


def _one_step(
    point: NDArray[np.float64], place: NDArray[np.float64], wxyz: NDArray[np.float64], way: str, turn: str, add: str
) -> NDArray[np.float64]:
    if way == "back":
        return _turned(wxyz * (1, -1, -1, -1), point - place)
    if turn == "translation alone":
        return point + _turned(wxyz, place)
    if add == "before":
        return _mistaken(turn, wxyz, point + place)
    factors = {"not": 0.0, "minus": -1.0, "twice": 2.0}
    return _mistaken(turn, wxyz, point) + factors.get(add, 1.0) * place * (1, 1, add != "flat")


def _mistaken(turn: str, wxyz: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn a point, with a mistake."""
    w, x, y, z = wxyz.tolist()
    if turn == "half":
        return (point + _turned(wxyz, point)) / 2
    if turn == "flat":
        angle = 2 * np.arctan2(z, w)
        wxyz = np.array([np.cos(angle / 2), 0.0, 0.0, np.sin(angle / 2)])
    if turn == "angle":
        length = np.linalg.norm([x, y, z]) or 1.0
        wxyz = np.array([np.cos(w / 2), *(np.sin(w / 2) * np.array([x, y, z]) / length)])
    others = {"not": (1.0, 0.0, 0.0, 0.0), "back": (w, -x, -y, -z), "w first": (x, y, z, w), "z, y, x, w": (w, z, y, x)}
    return _turned(np.array(others[turn]) if turn in others else wxyz, point)


def _turned(wxyz: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    axis = wxyz[1:]
    return np.asarray(point + 2 * np.cross(axis, np.cross(axis, point) + wxyz[0] * point))


def _say(numbers: tuple[float, ...]) -> str:
    return ", ".join(f"{number:z.3f}" for number in numbers)
