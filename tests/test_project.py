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


@pytest.mark.parametrize("name", [*STEPS, "fleet"])
def test_the_tutorials_projects_load(name):
    assert Project.load(find_project(name)).bodies


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


def test_a_simulation_publishes_its_time_where_its_project_says_so(write):
    text = "simulator: {clock: %s}\nbodies:\n  - {name: Tank, model: models/tank.xml}"
    project = Project.load(write(text % "true"))
    assert (project.clock, project.tree()) == (True, "+ World\n  + Tank\n  + Simulator (1 ms, /clock)")
    assert not Project.load(write(text % "false")).clock
    with pytest.raises(TutorialError, match=r"line 1: simulator\.clock: expected true or false, got a whole number\."):
        Project.load(write(text % "100"))


def test_a_fleet_stands_in_a_square_around_its_position(write):
    path = write("""
        bodies:
          - {name: Labo, model: models/tank.xml}
          - name: Tank
            model: models/tank.xml
            count: 5
            spacing: 2
            position: [10, 20, 0.1]
            controllers: [JointStateSubscriber]
    """)
    project = Project.load(path)
    assert project.tree() == "+ Labo\n+ Tank_1 to Tank_5\n  - JointStateSubscriber"
    assert [item.placement.name for item in project.bodies[1:]] == [f"Tank_{i}" for i in range(1, 6)]
    assert [item.placement.position for item in project.bodies[1:]] == [
        (9.0, 22.0, 0.1),
        (9.0, 20.0, 0.1),
        (9.0, 18.0, 0.1),
        (11.0, 22.0, 0.1),
        (11.0, 20.0, 0.1),
    ]
    without = project.with_controllers("Tank_3").tree()
    assert without.splitlines()[1:] == [
        "+ Tank_1 to Tank_2",
        "  - JointStateSubscriber",
        "+ Tank_3",
        "+ Tank_4 to Tank_5",
        "  - JointStateSubscriber",
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


MERGES = "\n".join(["a0: &a0 {x: 1}", *(f"a{i + 1}: &a{i + 1} {{<<: [{f'*a{i},' * 9}]}}" for i in range(9))])
"""Of one key, some four hundred millions, by merges of merges."""


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
        ("\n" + "[" * 20_000, "line 2: nested deeper than 20 levels, which nothing here needs."),
        ("- " * 20_000 + "1", "line 1: nested deeper than 20 levels, which nothing here needs."),
        ("a: {x: 1, x: 2}", "line 1: 'x' is there twice. Keep one."),
        ("bodies:\n  - name: A\n    model: m\n    name: B", "line 4: 'name' is there twice. Keep one."),
        ("bodies: &a {<<: *a}", "line 1: bodies: expected a list, got a mapping."),
        (MERGES, "line 4: a mapping of more than 100 keys, which nothing here needs."),
        ("bodies:\n  - \0", "line 2: this is not YAML: there is no character 0x0 in a text."),
        (f"bodies:\n  - {'9' * 50_000}", f"line 2: this is not YAML: '{'9' * 60}...' is no int."),
        (f"'{'k' * 900}': 1", f"line 1: '{'k' * 60}...' is not known here."),
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
        ("simulator: {time_step: 0}\nbodies: [{}]", "line 1: simulator.time_step: expected a number >= 0.0001."),
        ("simulator: {time_step: -1}\nbodies: [{}]", "line 1: simulator.time_step: expected a number >= 0.0001."),
        ("simulator: {time_step: 1e-300}\nbodies: [{}]", "line 1: simulator.time_step: expected a number >= 0.0001."),
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
        (
            "bodies:\n  - {name: Tank, model: models/tank.xml, count: 1001}",
            "line 2: bodies[0].count: expected a whole number <= 1000.",
        ),
        (
            "bodies:\n  - {name: Tank, model: models/tank.xml, count: 0}",
            "line 2: bodies[0].count: expected a whole number >= 1.",
        ),
        (
            "bodies:\n  - {name: Tank, model: models/tank.xml, count: 2.0}",
            "line 2: bodies[0].count: expected a whole number, got a number.",
        ),
        (
            "bodies:\n  - {name: Tank, model: models/tank.xml, spacing: 0}",
            "line 2: bodies[0].spacing: expected a number > 0.",
        ),
        (
            "bodies:\n  - {name: Tank_2, model: models/tank.xml}\n  - {name: Tank, model: models/tank.xml, count: 3}",
            "line 3: there is a body 'Tank_2' already. Give this one another name.",
        ),
        (
            "bodies:\n  - {name: T, model: models/tank.xml, count: 1000}\n  - {name: U, model: models/tank.xml}",
            "line 3: with this one there are 1001 bodies; 1000 are the most.",
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
            f"bodies:\n  - {{name: {'n' * 300}, model: models/tank.xml}}",
            f"line 2: '{'n' * 60}'... has 300 letters. Take a name of 60 at most.",
        ),
        (
            'bodies:\n  - {name: "A\\e[2J", model: models/tank.xml}',
            r"line 2: 'A\x1b[2J' cannot be part of a topic. Use letters, digits and _",
        ),
        ("bodies:\n  - {name: a/b, model: models/tank.xml}", "line 2: 'a/b' cannot be part of a topic. Use letters,"),
        (
            f"bodies:\n  - {{name: T, model: {'m' * 300}.xml}}",
            f"line 2: there is no model '{'m' * 60}'. Known are 'models/tank.xml'.",
        ),
        (
            'bodies:\n  - {name: T, model: "\\0.xml"}',
            r"line 2: there is no model '\x00.xml'. Known are 'models/tank.xml'",
        ),
        ("bodies:\n  - {name: T, model: models}", "line 2: there is no model 'models'. Known are 'models/tank.xml'"),
        (
            f"bodies:\n  - {{name: T, model: models/tank.xml, controllers: [{'C' * 300}]}}",
            f"line 2: there is no controller '{'C' * 60}'. Known are",
        ),
        (
            f"bodies:\n  - {{name: T, model: models/tank.xml, controllers: [{'C,' * 21}]}}",
            "line 2: bodies[0].controllers: expected a list of length <= 20.",
        ),
        (
            "bodies:\n  - {name: T, model: models/tank.xml, position: [1.0e+300, 0, 0]}",
            "line 2: bodies[0].position[0]: expected a number <= 10000.",
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
    path.write_bytes(b"\n\xff\xfe\x00")
    with pytest.raises(TutorialError, match=r"project\.yaml, line 2: this is not a text file in UTF-8"):
        Project.load(path)


def test_a_file_that_no_person_writes_is_not_read(tmp_path):
    path = tmp_path / "project.yaml"
    with path.open("wb") as file:
        file.truncate(10_000_000_000)  # takes no room on the disk
    with pytest.raises(TutorialError, match="has more than 100,000 bytes, which is no project that a person writes"):
        Project.load(path)


@pytest.mark.parametrize("given", ["x" * 300, "x\0y", "x/" * 3000, ".", "\x1b[2J"])
def test_what_is_no_path_leads_to_no_project(given):
    with pytest.raises(TutorialError, match=r"^there is no project '"):
        find_project(given)


BODY = "<mujoco><worldbody><body {}><freejoint/><geom size='{}'/></body></worldbody></mujoco>"


@pytest.mark.parametrize(
    ("model", "said"),
    [
        ("<mujoco><include file='tank.xml'/></mujoco>", "does not load. MuJoCo says:"),
        (BODY.format("quat='0 0 0 0'", "1"), "MuJoCo says:"),
        (BODY.format("", "1e300"), "has a body_mass that is no number, or far too large."),
        (BODY.format("pos='nan 0 0'", "1"), "has a qpos0 that is no number, or far too large."),
        ("\0", "does not load. MuJoCo says:"),
        ("x" * 10_000_001, "has more than 10,000,000 bytes. Make it smaller."),
    ],
    ids=["includes itself", "a quaternion of zeros", "too large", "NaN", "binary", "ten megabytes"],
)
def test_a_model_that_cannot_be_simulated_is_named_with_the_line(write, tmp_path, model, said):
    path = write("bodies:\n  - {name: T, model: models/tank.xml}")
    (tmp_path / "models" / "tank.xml").write_text(model)
    with pytest.raises(TutorialError) as info:
        Project.load(path)
    assert str(info.value).startswith(f"{path}, line 2: the ")
    assert said in str(info.value)


def test_another_robot_needs_a_file_whose_name_can_be_a_bodys(tmp_path):
    project = Project.load(find_project("step3"))
    for name, said in (("a<b>", "'A<b>' cannot be part of a topic"), ("r" * 70, "has 70 letters. Take a name of 60")):
        model = tmp_path / f"{name}.xml"
        model.write_text("<mujoco/>")
        with pytest.raises(TutorialError, match=f"the body is called after the file, and .*{said}"):
            project.with_robot(model)
    with pytest.raises(TutorialError, match="there is no model 'rrr"):
        project.with_robot(Path("r" * 300))


def test_the_steps_have_all_their_files():
    for step in STEPS:
        assert find_project(step) == HOME / "project" / f"{step}.yaml"
        assert find_launch_file(step) == HOME / "launch_py" / f"{step}.launch.py"
        assert Path(find_project(step)).is_file()
