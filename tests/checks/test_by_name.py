"""The exercise `by_name`: right answers in their styles, and what no edit of the solution tells."""

from __future__ import annotations

from collections import OrderedDict
from functools import partial
from math import isfinite, isnan

import numpy as np
import pytest

from tutorial.checks.by_name import by_name, match_by_name


def in_a_loop(joint_names, message):
    known, found = set(joint_names), {}
    for i in range(min(len(message.name), len(message.position))):
        if message.name[i] in known and isfinite(message.position[i]):
            found[message.name[i]] = message.position[i]
    return found


def from_the_end(joint_names, message):
    found = OrderedDict()
    for name, position in reversed([*zip(message.name, message.position)]):
        if not isnan(position):
            found.setdefault(name, position)
    return {name: found[name] for name in joint_names if name in found}


def in_numbers_of_numpy(joint_names, message):
    whole = {name: np.int64(q) for name, q in match_by_name(joint_names, message).items() if q == int(q)}
    return {np.str_(name): np.float32(q) for name, q in match_by_name(joint_names, message).items()} | whole


class Matcher:
    def __call__(self, joint_names, message):
        return match_by_name(joint_names, message)


def usable(is_usable, joint_names, message):
    return {n: q for n, q in zip(message.name, message.position) if n in joint_names and is_usable(q)}


@pytest.mark.parametrize(
    "answer",
    [in_a_loop, from_the_end, in_numbers_of_numpy, Matcher(), partial(usable, isfinite)],
)
def test_right_answers_are_right(answer):
    verdict = by_name.judge(answer)
    assert verdict.right, str(verdict)


def yields(joint_names, message):
    yield from match_by_name(joint_names, message).items()


def sorts(joint_names, message):
    message.name.sort()
    return match_by_name(joint_names, message)


def sorts_the_joints(joint_names, message):
    joint_names.sort()
    return match_by_name(joint_names, message)


def keeps(joint_names, message, found={}):  # noqa: B006 - the mistake
    found.update(match_by_name(joint_names, message))
    return found


def makes_one_dict(joint_names, message, found={}):  # noqa: B006 - the mistake
    found.clear()
    found.update(match_by_name(joint_names, message))
    return found


def looks_up_all(joint_names, message):
    positions = dict(zip(message.name, message.position))
    return {name: positions[name] for name in joint_names}


def in_whole_thousandths(joint_names, message):
    return {name: int(1000 * q) / 1000 for name, q in usable(lambda q: q == q, joint_names, message).items()}


def unpacks(joint_names, message):
    return {name: position for name, position in message.name if name in joint_names}


@pytest.mark.parametrize(
    ("answer", "cause", "text"),
    [
        (yields, "Return a dict from names to positions", "it returns a generator"),
        (sorts, "leave it as it is, take a copy", "the message is not the same"),
        (sorts_the_joints, "joint_names is changed", "joint_names is not the same"),
        (keeps, "the dict is kept from call to call", "it still says"),
        (makes_one_dict, "the dict is kept from call to call", "it still says"),
        (looks_up_all, "every joint is expected in every message", "only HATCH: it raises KeyError"),
        (in_whole_thousandths, "infinity is not expected", "it raises OverflowError"),
        (unpacks, "Mend this line first", "unpacks raised ValueError: too many values"),
    ],
)
def test_what_no_edit_tells_has_a_cause_too(answer, cause, text):
    verdict = by_name.judge(answer)
    assert [cause in named for named in verdict.causes] == [True], str(verdict)
    assert text in next(finding.text for finding in verdict.findings if not finding.right)
