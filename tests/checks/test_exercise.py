"""All exercises: their messages before an answer runs, and their solutions in a separate process."""

import ast
import asyncio
import importlib
import json
from types import SimpleNamespace

import pytest
from steps import BESIDE

from tutorial.checks.by_name import by_name
from tutorial.checks.catalogue import exercise_names, exercises
from tutorial.checks.drive import GentleTank, drive
from tutorial.checks.engine.verdict import right, wrong
from tutorial.checks.exercise import Exercise, listing
from tutorial.program.controller_files import controller_names
from tutorial.system.paths import HOME, PACKAGE

EXERCISES = [each for those in exercises().values() for each in those]
WITHOUT_CONTROLLER = {"nothing_arrives", "services"}  # steps whose exercises are about no controller of the course
every_exercise = pytest.mark.parametrize("exercise", EXERCISES, ids=lambda exercise: exercise.name)


def test_each_controller_has_exercises_with_their_own_names():
    titles = exercise_names()  # also those that need a real ROS 2
    names = {title.lstrip("0123456789_") for title in titles}
    files = {module.rpartition(".")[2] for module in controller_names().values()} - BESIDE
    assert all(sum(f"{file}_".startswith(f"{name}_") for name in names) == 1 for file in files)
    assert all(any(f"{file}_".startswith(f"{name}_") for file in files) for name in names - WITHOUT_CONTROLLER)
    others = {"catalogue", "exercise", "progress", "race_hints"}
    modules = {path.stem for path in (PACKAGE / "checks").glob("[!_]*.py")} - names - others
    assert modules == {each for those in titles.values() for each in those}, "the module of a step lists its exercises"
    for exercise in EXERCISES:
        assert getattr(importlib.import_module(exercise.module), exercise.name) is exercise
        assert exercise.name != exercise.right_answer.__name__, "the answer would hide the exercise"


@every_exercise
def test_hints_get_stronger_and_the_first_ones_give_nothing_away(exercise, capsys):
    assert exercise.right_answer.__name__ in exercise.__doc__
    for number in (1, 2, 3, 4):
        exercise.hint(number)
    first, second, third, fourth = capsys.readouterr().out.splitlines()
    assert first.startswith("Hint 1 of 3: ")
    assert first.endswith(f" {exercise.name}.hint(2) reveals more.")
    assert third.endswith(f" Still stuck? {exercise.name}.solution() prints a solution.")
    assert fourth == f"There are 3 hints: {exercise.name}.hint() to {exercise.name}.hint(3)."
    lines = [line.strip() for line in listing(exercise.right_answer).splitlines()]
    assert not any(len(line) > 20 and line in first + second for line in lines)


TEXT = "Repair.\n\nRepair it.\n\nHint 1: Look.\n\nHint 2: Think.\n\nHint 3: Write.\n\nNotice it."


@pytest.mark.parametrize(("rights", "wrongs", "number"), [(0, 1, 1), (2, 1, 2), (3, 1, 3), (3, 2, 2)])
def test_a_wrong_answer_gets_the_hint_that_fits(rights, wrongs, number, monkeypatch):
    findings = [right("a")] * rights + [wrong("b", f"Cause {i}.") for i in range(wrongs)]
    exercise = Exercise("repair", TEXT, SimpleNamespace(solution=GentleTank))
    monkeypatch.setattr(exercise, "findings", lambda *_: findings)
    says = {1: "what to look at", 2: "how it is done", 3: "nearly the code"}[number]
    assert str(exercise.judge(GentleTank)).splitlines()[-1] == f"Stuck? repair.hint({number}) says {says}."


BEFORE = (ast.Import, ast.ImportFrom, ast.ClassDef, ast.FunctionDef)


def imports_and_cell(name):
    """Return the imports, classes and functions before an answer's cell, and the cell's source."""
    found = []
    for path in sorted((HOME / "notebooks").glob("*.ipynb")):
        found.clear()
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            source = "".join(cell["source"])
            if cell["cell_type"] != "code" or source.startswith("%%"):  # IPython's own, not Python
                continue
            if any(f"{kind} {name}(" in source for kind in ("def", "class")) or f"class {name}:" in source:
                return "\n".join(found), source
            found += [ast.unparse(node) for node in ast.parse(source).body if isinstance(node, BEFORE)]
    raise AssertionError(f"no notebook has a cell for {name}")


@pytest.mark.process
@every_exercise
def test_the_printed_solution_is_right_in_its_notebook_and_in_a_separate_process(exercise, capfd):
    name = exercise.right_answer.__name__
    namespace = {"__name__": "__main__"}
    exec(imports_and_cell(name)[0], namespace)
    exercise.solution()
    source = capfd.readouterr().out
    assert not any(sign in source for sign in ('"""', "->", ": Joy", "ControllerConfig"))
    exec(source, namespace)
    asyncio.run(exercise.check(namespace[name]))
    said = capfd.readouterr().out
    assert "✗" not in said
    assert "\nAll right. Notice " in said


def unwritten(joint_names, message):
    """Match."""


class Pushy:
    def aim(self, stick):
        self.joint.effort = 1.0


FIRST_LOOK = [
    (drive, "Tank", "An object of the class str was passed. Pass the class itself: await drive.check(GentleTank)."),
    (drive, unwritten, "unwritten was passed. Pass the class itself: await drive.check(GentleTank)."),
    (drive, Pushy, "Pushy does not inherit from SimpleController. Define it as: class GentleTank(SimpleController):"),
    (by_name, Pushy, "Pushy was passed. Pass the function itself: await by_name.check(match_by_name)."),
]


@pytest.mark.parametrize(("exercise", "answer", "said"), FIRST_LOOK, ids=lambda value: str(value)[:24])
def test_an_answer_that_cannot_run_is_reported_at_once(exercise, answer, said, capsys):
    asyncio.run(exercise.check(answer))
    assert capsys.readouterr().out.startswith(said)


@every_exercise
def test_the_notebooks_own_cell_is_not_attempted(exercise, capsys):
    name = exercise.right_answer.__name__
    namespace = {"__name__": "__main__"}
    exec("\n".join(imports_and_cell(name)), namespace)
    asyncio.run(exercise.check(namespace[name]))
    asyncio.run(exercise.check())
    unwritten, nothing = capsys.readouterr().out.splitlines()
    methods = ", ".join(exercise._parts)
    assert unwritten == f"Not attempted yet: {name} is still to be written{': ' * bool(methods)}{methods}."
    assert nothing.startswith(f"Not attempted yet: write {name}, then await {exercise.name}.check({name}). ")
