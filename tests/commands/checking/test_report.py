"""Reporting answers that cannot be judged, by name."""

import asyncio
from pathlib import Path

import pytest

from tutorial.checks.engine.verdict import Verdict, right, wrong
from tutorial.checks.tank_controller import aim
from tutorial.commands.check import _names
from tutorial.commands.checking import submission
from tutorial.commands.checking._child import _judge
from tutorial.commands.checking.answers import find_answers
from tutorial.commands.checking.messages import FORGED, Judged, Outcome
from tutorial.ros import domains


def test_without_a_free_domain_no_answer_is_blamed(monkeypatch):
    monkeypatch.setattr(domains, "DOMAINS", [])
    cells = ["from tutorial.checks.tank_controller import aim", "HeldJoint = aim.right_answer"]
    (answer,) = find_answers(cells, {"aim": "HeldJoint"})
    judged = _judge(aim, answer)
    assert judged.outcome is Outcome.NOT_JUDGED
    assert judged.cause.startswith("all 0 ROS domains on this machine are taken: ")


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("", ""),
        ("All right", ""),
        (str(Verdict((right("it moves"), wrong("it stops", "it is too slow")))), ""),
        (str(Verdict((right("it moves"),))), "it is too slow"),
    ],
)
def test_a_fake_right_is_not_judged(text, cause):
    judged = Judged(Outcome.RIGHT, cause, text)
    assert (judged.outcome, judged.cause) == (Outcome.NOT_JUDGED, FORGED)


def test_an_answer_cannot_give_itself_a_score(monkeypatch, tmp_path):
    async def told(*_args):
        return Judged(Outcome.SCORED, score=100.0)

    monkeypatch.setattr(submission, "_told", told)
    judged = asyncio.run(submission._judge_one(tmp_path, "aim", 1.0, True))
    assert (judged.outcome, judged.cause, judged.score) == (Outcome.NOT_JUDGED, FORGED, None)


def test_a_right_answer_may_print_a_cross():
    text = str(Verdict((right("it moves"),), output=("✗ it stops",)))
    assert Judged(Outcome.RIGHT, "", text).outcome is Outcome.RIGHT


def test_a_notebooks_name_adds_no_line_to_the_table():
    first, second = Path("class/a\nben.ipynb"), Path("class/b\x1b.ipynb")
    assert _names([first, second]) == {first: "a\\nben.ipynb", second: "b\\x1b.ipynb"}
