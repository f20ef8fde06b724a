"""The hints of the race, which the notebook's learners print."""

from tutorial.checks.race_hints import HINTS, hint


def test_each_hint_names_the_next(capsys):
    for number in range(1, len(HINTS) + 2):
        hint(number)
    *hints, beyond = capsys.readouterr().out.splitlines()
    assert [line.partition(": ")[0] for line in hints] == ["Hint 1 of 3", "Hint 2 of 3", "Hint 3 of 3"]
    assert [line.rpartition(". ")[2] for line in hints[:2]] == [
        "hint(2) says how it is done.",
        "hint(3) says nearly the code.",
    ]
    assert beyond == "There are 3 hints: hint() to hint(3)."
