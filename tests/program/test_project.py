"""Project files, the errors in them, and a user's own controllers."""

import re
from pathlib import Path
from unittest.mock import Mock

import pytest

from tutorial import controllers
from tutorial.commands.options import part_class
from tutorial.controller import SimpleController
from tutorial.controllers.joint_state_publisher import JointStatePublisher
from tutorial.controllers.joint_state_subscriber import JointStateSubscriber
from tutorial.errors import TutorialError
from tutorial.program.controller_files import controller_names, find_controller, load_controllers
from tutorial.program.project import Project
from tutorial.system.paths import HOME, find_launch_file, find_project
from tutorial.world import Placement, compose, world_spec


@pytest.fixture
def write(tmp_path):
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "tank.xml").write_text("<mujoco/>")

    def write(text):
        path = tmp_path / "project.yaml"
        path.write_text(text)
        return path

    return write


def body(*items):
    """Return a project of bodies, one per line: a tank, unless the line says otherwise."""
    usual = ("name: Tank", "model: models/tank.xml")
    given = (", ".join([*(u for u in usual if u.split()[0] not in item), item]) for item in items or [""])
    return "bodies:" + "".join(f"\n  - {{{each}}}" for each in given)


def simulator(what):
    """Return a project with this simulator."""
    return f"simulator: {{{what}}}\nbodies: [{{}}]"


def test_the_item_tree_looks_like_the_originals():
    assert Project.load(find_project("step3")).tree() == "+ Tank\n  - JointStateSubscriber"
    tank = "  + Tank\n    - TankController\n    - JointStatePublisher"
    assert Project.load(find_project("step2")).tree() == f"+ World\n  + Labo\n{tank}\n  + Simulator (1 ms)"


def test_a_simulation_publishes_its_time_if_the_project_says_so(write):
    project = Project.load(write(body() + "\nsimulator: {clock: true}"))
    assert (project.clock, project.tree()) == (True, "+ World\n  + Tank\n  + Simulator (1 ms, /clock)")
    assert not Project.load(write(body() + "\nsimulator: {clock: false}")).clock


def test_a_fleet_is_a_square_around_its_position(write):
    fleet = "count: 5, spacing: 2, position: [10, 20, 0.1], controllers: [JointStateSubscriber]"
    project = Project.load(write(body(fleet, "name: Labo")))
    assert project.tree() == "+ Tank_1 to Tank_5\n  - JointStateSubscriber\n+ Labo"
    assert [item.placement.name for item in project.bodies] == [*(f"Tank_{i}" for i in range(1, 6)), "Labo"]
    places = [(9, 22, 0.1), (9, 20, 0.1), (9, 18, 0.1), (11, 22, 0.1), (11, 20, 0.1), (0, 0, 0)]
    assert [item.placement.position for item in project.bodies] == places
    carries = "  - JointStateSubscriber"
    without = ["+ Tank_1 to Tank_2", carries, "+ Tank_3", "+ Tank_4 to Tank_5", carries, "+ Labo"]
    assert project.with_controllers("Tank_3").tree().splitlines() == without


def test_every_controller_file_has_the_controller_of_its_name(backend):
    names = set(controller_names())
    assert {"TankController", "JointStatePublisher", "JointStateSubscriber"} <= names
    for name in names - ({"TankServer"} if backend == "pocket" else set()):
        assert find_controller(name).__name__ == name


@pytest.mark.pocket
def test_a_project_that_needs_services_says_how_to_get_them():
    said = r"step10\.yaml, line \d+: TankServer needs a real ROS 2, because .* To use it, run export TUTORIAL_ROS=rclpy"
    with pytest.raises(TutorialError, match=said):
        Project.load(find_project("step10"))


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("MyOwn", "class Mine:\n    pass\n", "has no class 'MyOwn'. Known: 'Mine'. A controller class must"),
        ("MyBroken", "1 / 0\n", "my_broken.py, line 1: ZeroDivisionError"),
    ],
)
def test_a_broken_controllers_file_is_reported_with_its_line(tmp_path, monkeypatch, name, text, said):
    (tmp_path / f"my_{name[2:].lower()}.py").write_text(text)
    monkeypatch.setattr(controllers, "__path__", [str(tmp_path)])
    with pytest.raises(TutorialError, match=re.escape(said)):
        find_controller(name)


def test_another_robot_replaces_the_controlled_one(tmp_path):
    project = Project.load(find_project("step3"))
    swapped = project.with_robot(HOME / "project" / "models" / "crane.xml")
    assert swapped.tree() == "+ Crane\n  - JointStateSubscriber"
    assert swapped.bodies[0].controllers == (JointStateSubscriber,)
    model = tmp_path / "a<b>.xml"
    model.write_text("<mujoco/>")
    with pytest.raises(TutorialError, match="the body is named after the file, and 'A<b>' cannot be part of a topic"):
        project.with_robot(model)
    with pytest.raises(TutorialError, match=r"the model 'm\\udce4\.xml' does not load\. .* can't encode character"):
        project.with_robot(Path("m\udce4.xml"))


def test_a_body_can_lack_geoms_of_its_model(write):
    project = Project.load(write(body(f"name: Tank, model: {HOME}/project/models/tank.xml, without: [ANTENNA]")))
    names = {geom.name for geom in world_spec([each.placement for each in project.bodies]).geoms}
    assert ("Tank/ANTENNA" in names, "Tank/ANTENNA_TIP" in names) == (False, True)
    with pytest.raises(TutorialError, match=r"labo\.xml has no geom 'ANTENNA'"):
        project.with_model("Tank", HOME / "project/models/labo.xml")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# nothing", "line 1: 'bodies' is missing here."),
        ("bodies: !tank [1]", "line 1: this is not YAML: could not determine a constructor for the tag '!tank'."),
        ("bodies: 2026-99-99", "line 1: this is not YAML: '2026-99-99' is not a valid timestamp."),
        ('bodies: "\\UFFFFFFFF"', "line 1: this is not YAML:"),
        ("bodies:\n  - name: A\n    name: B", "line 3: this is not YAML: 'name' appears twice. Keep one."),
        ("bodies:\n  - \0", "line 2: this is not YAML: unacceptable character #x0000"),
        ("bodies:\n  - !!null name: T", "line 2: a key here is not a string. Put it in quotes."),
        ("bodies:\n  - {<<: {nme: Tank}, model: x}", "line 2: unknown key 'nme'. Did you mean 'name'?"),
        (body("\n    contollers: []"), "line 3: unknown key 'contollers'. Did you mean 'controllers'?"),
        ("- 1", "line 1: expected a mapping, got a list."),
        (simulator("clock: 100"), "line 1: simulator.clock: expected true or false, got a whole number."),
        (simulator("time_step: 1e-300"), "line 1: simulator.time_step: expected a number >= 0.0001."),
        (body("count: 1001"), "line 2: bodies[0].count: expected a whole number <= 1000."),
        (body("position: [1, 2,\n  a]"), "line 3: bodies[0].position[2]: expected a number, got text."),
        (body("controllers: [\n  TankControler]"), "line 3: there is no controller 'TankControler'. Did you mean 'T"),
        (body("name: Tank_2", "count: 3"), "line 3: there is already a body 'Tank_2'. Rename this one."),
        (
            body("name: My Tank"),
            "line 2: 'My Tank' cannot be part of a topic name. Use letters, digits and _, starting",
        ),
        (body('name: "A\\e[2J"'), r"line 2: 'A\x1b[2J' cannot be part of a topic name."),
        (body("name: _T"), "line 2: '_T' cannot be part of a topic name."),
        (body("name: Öl"), "line 2: 'Öl' cannot be part of a topic name."),
        (body("model: models/tnak.xml"), "line 2: there is no model 'models/tnak.xml'. Did you mean 'models/tank."),
        (body("without: [GUN]"), "line 2: tank.xml has no geom 'GUN'. There are none."),
        (body('model: "\\0.xml"'), r"line 2: there is no model '\x00.xml'. Known: 'models/tank.xml'."),
    ],
)
def test_an_error_is_reported_with_its_line_and_the_fix(write, text, said):
    path = write(text)
    with pytest.raises(TutorialError, match=f"^{re.escape(f'{path}, {said}')}"):
        Project.load(path)


@pytest.mark.parametrize(
    ("find", "said"),
    [
        (lambda folder: find_project(f"{folder}/stp3.yaml"), r"project '.*stp3\.yaml'\. Did you mean 'step3\.yaml"),
        (lambda folder: find_project("stp3"), r"project 'stp3'\. Did you mean 'step3'\?"),
        (lambda folder: find_launch_file("step33"), r"launch file 'step33'\. Did you mean 'step3'\?"),
        *(
            (lambda folder, given=given: find_project(given), r"project '")
            for given in ("x" * 300, "x\0y", "x/" * 3000, ".", "\x1b[2J")
        ),
    ],
)
def test_a_missing_file_gets_the_nearest_name_as_a_suggestion(tmp_path, find, said):
    (tmp_path / "step3.yaml").write_text("")
    with pytest.raises(TutorialError, match=f"^there is no {said}"):
        find(tmp_path)


def test_a_file_that_is_not_text_is_reported_with_its_line(tmp_path):
    path = tmp_path / "project.yaml"
    path.write_bytes(b"\n\xff\xfe\x00")
    with pytest.raises(TutorialError, match=r"project\.yaml, line 2: this is not a UTF-8 text file"):
        Project.load(path)


@pytest.mark.parametrize(
    ("model", "said"),
    [
        ("<mujoco><worldbody><geom type='cube'/></worldbody></mujoco>", "' does not load. MuJoCo reports: XML Error"),
        ("<mujoco><worldbody><body name='\xe4'><geom size='1'/></body></worldbody></mujoco>", "can't decode byte 0xe4"),
    ],
    ids=["wrong", "Latin-1"],
)
def test_a_model_that_cannot_be_simulated_is_reported_with_its_line(write, tmp_path, model, said):
    path = write(body())
    (tmp_path / "models" / "tank.xml").write_text(model, encoding="latin-1")
    with pytest.raises(TutorialError, match=rf"^{re.escape(str(path))}, line 2: the .*{said}"):
        Project.load(path)


def test_a_model_that_does_not_fit_into_memory_is_reported(monkeypatch):
    no_memory = Mock(side_effect=RuntimeError("Could not allocate memory"))
    monkeypatch.setattr("mujoco.MjSpec.from_file", no_memory)
    with pytest.raises(TutorialError, match=r"the model 'a\.xml' does not load\. MuJoCo reports: Could not allocate"):
        compose([Placement("Field", Path("a.xml"))])


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


class Mine(SimpleController):
    """A controller of this test."""


@pytest.fixture
def own(tmp_path):
    def write(text, name="mine.py"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return write


@pytest.fixture
def step2():
    return Project.load(find_project("step2"))


def test_an_own_controller_replaces_the_librarys(own, step2):
    classes = load_controllers(own(OWN))
    assert list(classes) == ["TankController"], "only classes that the file itself defines"
    assert step2.with_own(classes).bodies[1].controllers == (classes["TankController"], JointStatePublisher)
    assert step2.with_own(classes).tree() == step2.tree().replace("TankController", "TankController (mine.py)")
    helped = own(OWN.replace("TankController", "Helper") + "class TankController(Helper):\n    pass\n")
    assert step2.with_own(load_controllers(helped)).bodies[1].controllers[0].__name__ == "TankController"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = 1\n", "defines no controller. A controller is a class derived from SimpleController."),
        ("import sys\nsys.exit()\n", "mine.py, line 2: SystemExit"),
        ("class A(:\n", "mine.py, line 1: SyntaxError"),
        ("def f():\n    return 1 / 0\nf()\n", "mine.py, line 2, in f: ZeroDivisionError"),
    ],
)
def test_an_error_in_an_own_file_is_reported_with_its_line(own, monkeypatch, text, said):
    path = own(text)
    monkeypatch.chdir(path.parent)
    for given in (path, Path("mine.py")):
        with pytest.raises(TutorialError, match=said):
            load_controllers(given)


def test_one_of_a_files_controllers_is_chosen(own):
    two = own(OWN + "class Other(TankController):\n    pass\n")
    assert list(load_controllers(two)) == ["TankController", "Other"]
    assert list(load_controllers(two, "Other")) == ["Other"]
    for path, name, said in (
        (two, "Othr", r"mine\.py defines no controller 'Othr'\. Did you mean 'Other'\?"),
        (two.with_name("mien.py"), None, r"there is no file .* Did you mean .*mine\.py"),
        (own(OWN, "mine.txt"), None, "is not a Python file"),
    ):
        with pytest.raises(TutorialError, match=said):
            load_controllers(path, name)


@pytest.mark.parametrize(
    ("given", "file", "controller"),
    [("a.py", "a.py", None), ("a.py:B", "a.py", "B"), ("a:b/c.py", "a:b/c.py", None), (":B", ":B", None)],
)
def test_file_and_controller_are_split_at_the_last_colon(given, file, controller):
    assert part_class(given) == (Path(file), controller)


def test_a_body_is_given_controllers(step2):
    assert step2.with_controllers("Tank", Mine).bodies[1].controllers == (Mine,)
    assert step2.with_controllers("Tank").bodies[1].controllers == ()
    assert step2.bodies[1].controllers != ()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda p: p.with_own({"TankControler": Mine}), r"step2\.yaml has no controller 'TankControler'\. Did you"),
        (lambda p: p.with_controllers("tank", Mine), r"step2\.yaml has no body 'tank'\. Did you mean 'Tank'"),
        *(
            (lambda p, given=given: p.with_controllers("Tank", given), r"is not a controller\. Give a class derived")
            for given in (Mine(), int, "Mine", print)
        ),
    ],
)
def test_an_unused_name_or_a_non_controller_is_refused(step2, change, said):
    with pytest.raises(TutorialError, match=said):
        change(step2)
