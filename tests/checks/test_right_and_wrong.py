"""Right answers in various styles, and wrong answers: see the folder ``answers``."""

from importlib import import_module

import pytest

from tutorial.checks.catalogue import exercises

EXERCISES = {each.name: each for those in exercises().values() for each in those}
ANSWERS = {name: import_module(f"answers.{name}") for name in EXERCISES}
RIGHT = [(name, answer) for name, module in ANSWERS.items() for answer in module.RIGHT]
WRONG = [(name, *each) for name, module in ANSWERS.items() for each in getattr(module, "WRONG", ())]


def named(value):
    return value if isinstance(value, str) else getattr(value, "__name__", "")


@pytest.mark.parametrize(("name", "answer"), RIGHT, ids=named)
def test_right_answers_are_right(name, answer, domain):
    verdict = EXERCISES[name].judge(answer)
    assert verdict.right, str(verdict)


@pytest.mark.parametrize(("name", "answer", "causes"), WRONG, ids=named)
def test_wrong_answers_get_their_causes(name, answer, causes, domain):
    wanted = [causes] if isinstance(causes, str) else causes
    verdict = EXERCISES[name].judge(answer)
    told = verdict.causes
    assert len(told) == len(wanted), str(verdict)
    assert all(part in cause for part, cause in zip(wanted, told)), str(verdict)
