"""The exercise `by_name`: right answers in various styles, and wrong ones."""

from collections import OrderedDict
from functools import partial
from math import isfinite, isinf, isnan

import numpy as np

from tutorial.checks.by_name import match_by_name


def from_the_end(joint_names, message):
    found = OrderedDict()
    for name, position in reversed([*zip(message.name, message.position)]):
        if not (isnan(position) or isinf(position)):
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


RIGHT = [from_the_end, in_numbers_of_numpy, Matcher(), partial(usable, isfinite)]


def yields(joint_names, message):
    yield from match_by_name(joint_names, message).items()


def makes_one_dict(joint_names, message, found={}):  # noqa: B006 - the mistake
    found.clear()
    found.update(match_by_name(joint_names, message))
    return found


def looks_up_all(joint_names, message):
    return {name: dict(zip(message.name, message.position))[name] for name in joint_names}


def filters_first(joint_names, message):
    known = (name for name in message.name if name in joint_names)
    return {name: q for name, q in zip(known, message.position) if q == q}


def in_whole_thousandths(joint_names, message):
    return {name: int(1000 * q) / 1000 for name, q in usable(lambda q: q == q, joint_names, message).items()}


WRONG = [
    (yields, "Return a dict that maps names to positions"),
    (makes_one_dict, "reuses one dict, such as a default argument"),
    (looks_up_all, "expects every joint in every message"),
    (filters_first, ["before zip", "only for NaN"]),
    (in_whole_thousandths, ["converts or rounds", "only for NaN"]),
]
