"""A user's own controllers: read from a file, and put in the library's place."""

from __future__ import annotations

from pathlib import Path

import pytest

from tutorial.commands.options import part_class
from tutorial.controller import SimpleController
from tutorial.controllers.joint_state_publisher import JointStatePublisher
from tutorial.errors import TutorialError
from tutorial.paths import find_project
from tutorial.project import Project, load_controllers

OWN = """
from dataclasses import dataclass
from tutorial.controller import SimpleController
from tutorial.controllers.joint_state_publisher import JointStatePublisher

@dataclass
class Gains:
    p: float = 200.0

class TankController(SimpleController):
    def configure(self, config):
        self.gains = Gains()
"""


@pytest.fixture
def own(tmp_path):
    def write(text):
        path = tmp_path / "mine.py"
        path.write_text(text)
        return path

    return write


@pytest.fixture
def step2():
    return Project.load(find_project("step2"))


def test_only_what_the_file_itself_defines_is_taken(own):
    assert list(load_controllers(own(OWN))) == ["TankController"]


def test_an_own_controller_takes_the_place_of_the_librarys(own, step2):
    classes = load_controllers(own(OWN))
    tank = step2.with_own(classes).bodies[1]
    assert tank.controllers == (classes["TankController"], JointStatePublisher)
    assert step2.with_own(classes).tree() == step2.tree().replace("TankController", "TankController (mine.py)")


def test_what_an_own_controller_is_made_from_may_have_any_name(own, step2):
    helped = own(OWN.replace("TankController", "Helper") + "class TankController(Helper):\n    pass\n")
    assert step2.with_own(load_controllers(helped)).bodies[1].controllers[0].__name__ == "TankController"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = 1\n", "defines no controller: a class made from SimpleController."),
        ("import nothing_of_this_name\n", "mine.py, line 1: ModuleNotFoundError"),
        ("import sys\nsys.exit()\n", "mine.py, line 2: SystemExit"),
        ("class A(:\n", "mine.py, line 1: SyntaxError"),
        ("def f():\n    return 1 / 0\nf()\n", "mine.py, line 2, in f: ZeroDivisionError"),
    ],
)
def test_a_file_that_is_wrong_is_named_with_its_line(own, text, said):
    with pytest.raises(TutorialError) as info:
        load_controllers(own(text))
    assert said in str(info.value)


def test_the_line_is_named_whichever_way_the_path_is_given(own, monkeypatch):
    monkeypatch.chdir(own("x = 1\n1 / 0\n").parent)
    with pytest.raises(TutorialError, match=r"^mine\.py, line 2: ZeroDivisionError"):
        load_controllers(Path("mine.py"))


def test_one_of_a_files_controllers_is_asked_for(own):
    two = own(OWN + "class Other(TankController):\n    pass\n")
    assert list(load_controllers(two)) == ["TankController", "Other"]
    assert list(load_controllers(two, "Other")) == ["Other"]
    with pytest.raises(TutorialError, match=r"defines no controller 'Othr'\. Did you mean 'Other'\?"):
        load_controllers(two, "Othr")


@pytest.mark.parametrize(
    ("given", "file", "controller"),
    [
        ("a.py", "a.py", None),
        ("a.py:B", "a.py", "B"),
        ("a:b/c.py", "a:b/c.py", None),
        (":B", ":B", None),
        ("", "", None),
    ],
)
def test_file_and_controller_are_parted_at_the_last_colon(given, file, controller):
    assert part_class(given) == (Path(file), controller)


def test_a_file_that_there_is_not(own):
    near = own(OWN)
    with pytest.raises(TutorialError, match=r"there is no file .* Did you mean .*mine\.py"):
        load_controllers(near.with_name("mien.py"))
    with pytest.raises(TutorialError, match="is no Python file"):
        load_controllers(near.rename(near.with_suffix(".txt")))


def test_an_own_controller_whose_name_the_project_does_not_have(step2):
    class TankControler(SimpleController):
        pass

    with pytest.raises(TutorialError, match=r"step2\.yaml has no controller 'TankControler'\. Did you mean 'TankContr"):
        step2.with_own({"TankControler": TankControler})


def test_a_body_is_given_controllers(step2):
    class Mine(SimpleController):
        pass

    assert step2.with_controllers("Tank", Mine).bodies[1].controllers == (Mine,)
    assert step2.with_controllers("Tank").bodies[1].controllers == ()
    assert step2.bodies[1].controllers != ()


def test_what_is_no_body_and_what_is_no_controller(step2):
    class Mine(SimpleController):
        pass

    with pytest.raises(TutorialError, match=r"step2\.yaml has no body 'tank'\. Did you mean 'Tank'"):
        step2.with_controllers("tank", Mine)
    for given in (Mine(), int, "Mine", print):
        with pytest.raises(TutorialError, match=r"is no controller\. Give the class itself"):
            step2.with_controllers("Tank", given)
