"""Project files: what they say, and what is said when they are wrong."""

from __future__ import annotations

import sys
import textwrap
from pathlib import Path

import pytest

from tutorial import controllers
from tutorial.controllers.joint_state_subscriber import JointStateSubscriber
from tutorial.errors import TutorialError
from tutorial.paths import HOME, find_launch_file, find_project
from tutorial.project import Project, controller_names, find_controller

STEPS = ("step1", "step2", "step3")


@pytest.fixture
def write(tmp_path):
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "tank.xml").write_text("<mujoco/>")

    def write(text):
        path = tmp_path / "project.yaml"
        path.write_text(textwrap.dedent(text))
        return path

    return write


@pytest.mark.parametrize("step", STEPS)
def test_the_steps_projects_load(step):
    assert Project.load(find_project(step)).bodies


def test_the_item_tree_is_drawn_as_in_the_original():
    assert Project.load(find_project("step3")).tree() == "+ Tank\n  - JointStateSubscriber"
    assert Project.load(find_project("step2")).tree().splitlines() == [
        "+ World",
        "  + Labo",
        "  + Tank",
        "    - TankController",
        "    - JointStatePublisher",
        "  + Simulator (1 ms)",
    ]


def test_every_controller_file_holds_the_controller_that_it_is_called_after():
    names = controller_names()
    assert {"TankController", "JointStatePublisher", "JointStateSubscriber"} <= set(names)
    for name in names:
        assert find_controller(name).__name__ == name


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "class Mine:\n    pass\n",
            "has no class 'MyOwn'. Known are 'Mine'. A controller's class is called like",
        ),
        (
            "import nothing_of_this_name\n",
            "my_own.py, line 1: ModuleNotFoundError: No module named 'nothing_of",
        ),
        ("def f(:\n", "my_own.py, line 1: SyntaxError: invalid syntax"),
    ],
)
def test_a_broken_controllers_file_is_named_with_its_line(tmp_path, monkeypatch, text, said):
    (tmp_path / "my_own.py").write_text(text)
    monkeypatch.setattr(controllers, "__path__", [str(tmp_path)])
    monkeypatch.delitem(sys.modules, "tutorial.controllers.my_own", raising=False)
    with pytest.raises(TutorialError) as info:
        find_controller("MyOwn")
    assert said in str(info.value)


def test_another_robot_takes_the_place_of_the_one_with_controllers():
    crane = HOME / "project" / "models" / "crane.xml"
    swapped = Project.load(find_project("step3")).with_robot(crane)
    assert swapped.tree() == "+ Crane\n  - JointStateSubscriber"
    assert swapped.bodies[0].controllers == (JointStateSubscriber,)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "line 1: the file is empty."),
        ("bodies: [", "line 1: this is not YAML:"),
        ("bodies:\n  - name: Tank\n   model: x", "line 3: this is not YAML:"),
        ("bodies: !tank [1]", "line 1: this is not YAML: could not determine a constructor for the tag '!tank'."),
        ("bodies: 2026-99-99", "line 1: this is not YAML: '2026-99-99' is no timestamp."),
        ("bodies:\n  - !!bool x", "line 2: this is not YAML: 'x' is no bool."),
        ("bodies:\n  - !!timestamp x", "line 2: this is not YAML: 'x' is no timestamp."),
        ('bodies: "\\UFFFFFFFF"', "line 1: this is not YAML:"),
        ("[" * 2000, "line 1: this is not YAML: maximum recursion depth exceeded"),
        ("bodies: []\n`a`: 1", "line 2: this is not YAML: while scanning for the next token"),
        ('simulator: {}\n"`a`": 1', "line 2: '`a`' is not known here. Known are 'bodies', 'simulator'."),
        ('bodies:\n  - "na`me": T', "line 2: 'na`me' is not known here. Did you mean 'name'?"),
        ("simulator: {}\n1: 1", "line 2: '1' is not known here. Known are 'bodies', 'simulator'."),
        ("bodies:\n  - !!null name: T", "line 2: 'name' is not known here. Did you mean 'name'?"),
        ("bodies: !!set {Tank}", "line 1: bodies: expected a list, got a set."),
        ("bodies:\n  - !!set {name, model}", "line 2: bodies[0]: expected a mapping, got a set."),
        ("bodies: !!omap [name: T]", "line 1: bodies[0]: expected a mapping, got a tuple."),
        ("bodies: &a [*a]", "line 1: bodies[0]: expected a mapping, got a list."),
        ("bodies:\n  - {model: m, name: 1}", "line 2: bodies[0].name: expected a text, got a whole number."),
        ("simulator: {time_step: 0}", "line 1: 'bodies' is missing here."),
        ("simulator: {time_step: true}\nbodies: [{}]", "line 1: simulator.time_step: expected a number, got true or"),
        ("simulator: {time_step: 0}\nbodies: [{}]", "line 1: simulator.time_step: expected a number > 0."),
        (
            "simulator: {time_step: .nan}\nbodies: [{}]",
            "line 1: simulator.time_step: expected a number that is finite.",
        ),
        (
            f"bodies:\n  - {{name: T, model: m, position: [0, 0, {10**400}]}}",
            "line 2: bodies[0].position[2]: expected a number that is finite.",
        ),
        ("bodies:\n  - {<<: {nme: Tank}, model: x}", "line 2: 'nme' is not known here. Did you mean 'name'?"),
        ("- 1", "line 1: expected a mapping, got a list."),
        ("simulator: {}", "line 1: 'bodies' is missing here."),
        ("bodies: Tank", "line 1: bodies: expected a list, got a text."),
        ("bodies: []", "line 1: bodies: expected a list of length >= 1."),
        ("bodies:\n  - name: Tank\n", "line 2: 'model' is missing here."),
        (
            "bodies:\n  - name: Tank\n    model: models/tank.xml\n    contollers: []",
            "line 4: 'contollers' is not known here. Did you mean 'controllers'?",
        ),
        (
            "simulator:\nbodies:\n  - {name: T, model: models/tank.xml}",
            "line 1: simulator: expected a mapping, got nothing.",
        ),
        ("bodys: []", "line 1: 'bodys' is not known here. Did you mean 'bodies'?"),
        (
            "bodies:\n  - name: Tank\n    model: models/tank.xml\n    position: [1, 2]",
            "line 4: bodies[0].position: expected a list of length 3, got 2.",
        ),
        (
            "bodies:\n  - name: Tank\n    model: models/tank.xml\n    position: [1, 2, a]",
            "line 4: bodies[0].position[2]: expected a number, got a text.",
        ),
        (
            "bodies:\n  - name: My Tank\n    model: models/tank.xml",
            "line 2: 'My Tank' cannot be part of a topic. Use letters, digits and _",
        ),
        (
            "bodies:\n  - name: Tank\n    model: models/tnak.xml",
            "line 3: there is no model 'models/tnak.xml'. Did you mean 'models/tank.xml'?",
        ),
        (
            "bodies:\n  - name: Tank\n    model: models/tank.xml\n    controllers:\n      - TankControler",
            "line 5: there is no controller 'TankControler'. Did you mean 'TankController'?",
        ),
        (
            "bodies:\n  - {name: T, model: models/tank.xml}\n  - {name: T, model: models/tank.xml}",
            "line 3: there is a body 'T' already. Give this one another name.",
        ),
        (
            "simulator:\n  time_step: 1\nbodies:\n  - {name: T, model: models/tank.xml}",
            "line 2: simulator.time_step: expected a number <= 0.01.",
        ),
    ],
)
def test_what_is_wrong_is_named_with_its_line_and_the_mend(write, text, said):
    path = write(text)
    with pytest.raises(TutorialError) as info:
        Project.load(path)
    assert str(info.value).startswith(f"{path}, {said}")


def test_a_missing_file_is_named_with_the_nearest(tmp_path):
    (tmp_path / "step3.yaml").write_text("")
    with pytest.raises(TutorialError, match=r"there is no project '.*stp3\.yaml'\. Did you mean 'step3\.yaml'\?"):
        find_project(str(tmp_path / "stp3.yaml"))
    with pytest.raises(TutorialError, match=r"there is no project 'stp3'\. Did you mean 'step3'\?"):
        find_project("stp3")
    with pytest.raises(TutorialError, match=r"there is no launch file 'step33'\. Did you mean 'step3'\?"):
        find_launch_file("step33")


def test_a_file_that_is_no_text_is_said(tmp_path):
    path = tmp_path / "project.yaml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(TutorialError, match="not a text file in UTF-8"):
        Project.load(path)


def test_the_steps_have_all_their_files():
    for step in STEPS:
        assert find_project(step) == HOME / "project" / f"{step}.yaml"
        assert find_launch_file(step) == HOME / "launch_py" / f"{step}.launch.py"
        assert Path(find_project(step)).is_file()
