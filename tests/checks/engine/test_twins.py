"""The solution with mistakes in it."""

from dataclasses import replace

from tutorial.checks.engine import cases
from tutorial.checks.engine.trial import Trial
from tutorial.checks.engine.twins import Twins

from . import toys


def test_twins_are_the_solution_with_mistakes():
    add, multiply, *_ = toys.TOY.faults
    assert toys.TWINS.make(add, multiply)(4) == 18
    assert toys.TWINS.make(add, add) is None
    assert toys.TWINS.does(toys.CASES[1], add) == 6
    (partly,) = cases.Mistake("", cases.replace("2 * x", "partial(max, 9)(x)")).faults()
    assert toys.TWINS.make(partly)(4) == 10


def test_their_output_and_time_are_not_charged_to_the_answer(capsys):
    begun = []

    def begin(*given):
        begun.append(Trial(*given))
        return begun[-1]

    prints = cases.Mistake("", cases.replace("return", "print(x)\nreturn")).faults()[0]
    twins = Twins(replace(toys.TOY, mistakes=[]), begin)
    assert twins.shows(toys.CASES[0], prints) is False
    assert capsys.readouterr() == ("", "")
    assert [trial.is_timed for trial in begun] == [False, True]
