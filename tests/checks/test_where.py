"""The exercise `where`: every wrong answer is told its cause."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from tutorial.checks.pose import turned, where, where_is

# --- right answers


def recursive(transforms, point):
    if not transforms:
        return list(point)
    first, *others = transforms
    t, inner = first.transform.translation, turned(first.transform.rotation, recursive(others, point))
    return (inner[0] + t.x, inner[1] + t.y, inner[2] + t.z)


def by_matrices(transforms, point):
    whole = np.eye(4)
    for stamped in transforms:  # matrices may be multiplied from the outside, too
        t, q = stamped.transform.translation, stamped.transform.rotation
        turn, one = np.empty(9), np.eye(4)
        mujoco.mju_quat2Mat(turn, np.array([q.w, q.x, q.y, q.z]))
        one[:3, :3], one[:3, 3] = turn.reshape(3, 3), (t.x, t.y, t.z)
        whole = whole @ one
    return (whole @ [*point, 1.0])[:3].tolist()


@pytest.mark.parametrize("answer", [where_is, recursive, by_matrices])
def test_right_answers_are_right(answer):
    verdict = where.judge(answer)
    assert verdict.right, str(verdict)


# --- wrong answers


def steps(transforms):
    return [(each.transform.rotation, np.array(xyz(each.transform.translation))) for each in transforms]


def xyz(vector):
    return [vector.x, vector.y, vector.z]


class Q:
    """A quaternion that is not the message's."""

    def __init__(self, w, x, y, z):
        self.w, self.x, self.y, self.z = w, x, y, z


def chained(one_step, choose=reversed):
    """An answer that goes through the transforms."""

    def answer(transforms, point):
        point = np.array(point, float)
        for q, t in choose(steps(transforms)):
            point = one_step(q, t, point)
        return point

    return answer


def right_step(q, t, point):
    return turned(q, point) + t


def with_quaternion(change):
    return chained(lambda q, t, point: turned(change(q), point) + t)


def flat(q):
    half = np.arctan2(q.z, q.w)
    return Q(np.cos(half), 0.0, 0.0, np.sin(half))


def half(q, t, point):
    axis = np.array([q.x, q.y, q.z])
    return point + np.cross(axis, np.cross(axis, point) + q.w * point) + t


def sums_up(transforms, point):
    place = np.zeros(3)
    for q, t in reversed(steps(transforms)):
        point, place = turned(q, point), place + t
    return np.array(point) + place


def only_one(transforms, point):
    (stamped,) = transforms
    return right_step(*steps([stamped])[0], point)


def first_of_all(transforms, point):
    point = right_step(*steps(transforms)[-1], point)
    for q, t in steps(transforms)[-2::-1]:
        point = right_step(q, t, point)
    return point


def no_return(transforms, point):
    where_is(transforms, point)


def as_dict(transforms, point):
    return dict(zip("xyz", where_is(transforms, point)))


def as_text(transforms, point):
    return str(where_is(transforms, point))


def as_message(transforms, point):
    t = transforms[0].transform.translation
    t.x, t.y, t.z = where_is(transforms, point)
    return t


def two_numbers(transforms, point):
    return list(where_is(transforms, point))[:2]


def pops(transforms, point):
    while transforms:
        point = right_step(*steps([transforms.pop()])[0], point)
    return point


WRONG = [
    (chained(right_step, list), "the order is the wrong way round"),
    (chained(right_step, lambda all_: all_[-1:]), "only the last transform is used"),
    (chained(right_step, lambda all_: all_[:1]), "only the first transform is used"),
    (chained(right_step, lambda all_: all_[-2::-1]), "the last transform is left out"),
    (chained(right_step, lambda all_: all_[:0:-1]), "the first transform is left out"),
    (chained(lambda q, t, point: turned(Q(q.w, -q.x, -q.y, -q.z), point - t)), "it goes the wrong way"),
    (chained(lambda _, t, point: point + t), "the rotation is left out"),
    (with_quaternion(lambda q: Q(q.w, -q.x, -q.y, -q.z)), "it is turned the wrong way round"),
    (with_quaternion(lambda q: Q(q.x, q.y, q.z, q.w)), "x is taken for w: in ROS the order is x, y, z, w"),
    (with_quaternion(lambda q: Q(q.w, q.z, q.y, q.x)), "the axis is in reverse order"),
    (with_quaternion(flat), "only the turn about z counts"),
    (chained(half), "the 2 is missing"),
    (chained(lambda q, t, point: point + turned(q, t)), "the translation is turned, and the point is not"),
    (chained(lambda q, t, point: turned(q, point + t)), "the translation is added before the turn"),
    (chained(lambda q, _, point: turned(q, point)), "the translation is left out"),
    (chained(lambda q, t, point: turned(q, point) - t), "the translation is taken off"),
    (chained(lambda q, t, point: turned(q, point) + t * (1, 1, 0)), "only x and y of the translation are added"),
    (chained(lambda q, t, point: turned(q, point) + 2 * t), "the translation is added twice"),
    (sums_up, "the translations are added up, and not turned"),
    (lambda transforms, _: where_is(transforms, (0.0, 0.0, 0.0)), "the point itself is left out"),
    (lambda transforms, p: np.array(p) + where_is(transforms, (0.0, 0.0, 0.0)), "the point is added at the end"),
    (lambda transforms, p: where_is(transforms, (p[0], p[1], 0.0)), "z of the point is left out"),
    (lambda transforms, p: [round(float(each), 2) for each in where_is(transforms, p)], "the result is rounded"),
    (lambda transforms, p: where_is(transforms, p)[::-1], "z, y, x is returned"),
    (only_one, "a certain number of transforms is expected"),
    (first_of_all, "a first transform is taken for granted"),
    (no_return, "return is missing"),
    (as_dict, "Return x, y and z: a list"),
    (as_text, "Return x, y and z: a list"),
    (two_numbers, "Return x, y and z: a list"),
    (as_message, "a message is no list"),
    (pops, "changes what was given"),
]


@pytest.mark.parametrize(("answer", "cause"), WRONG, ids=[cause for _, cause in WRONG])
def test_wrong_answers_are_told_their_cause(answer, cause):
    verdict = where.judge(answer)
    assert not verdict.right
    assert cause in verdict.causes[0], str(verdict)


def test_two_mistakes_are_both_named():
    verdict = where.judge(chained(lambda q, t, point: turned(q, point) - t, list))
    assert len(verdict.causes) == 2, str(verdict)


def test_an_unknown_mistake_is_told_what_to_compare_with():
    verdict = where.judge(lambda transforms, point: np.array(point) * len(transforms) * 1.7)
    assert verdict.causes[0].startswith("Compare with: from the last transform to the first"), str(verdict)
