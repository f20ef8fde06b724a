"""`tank package`: it writes a ROS 2 package as REP 149 and colcon expect it, and never overwrites a file."""

from xml.etree import ElementTree

import pytest
from click.testing import CliRunner
from packages import CONTROLLERS, install, need_setuptools, run

from tutorial.commands.package import package
from tutorial.commands.packaging import contents
from tutorial.commands.packaging.contents import NOBODY, find_maintainer
from tutorial.errors import TutorialError
from tutorial.system.paths import HOME

ANN = ('Ann "A" <O\'Hara> & Son', "ann@example.com")
COMMON = {"README.md", "package.xml", "setup.cfg", "setup.py"}


@pytest.fixture
def here(tmp_path, monkeypatch):
    """The current directory, with a learner's file of two controllers, on a machine where git knows the user."""
    (tmp_path / "mine.py").write_text(CONTROLLERS)
    monkeypatch.setattr(contents, "_ask_git", dict(zip(("user.name", "user.email"), ANN)).__getitem__)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def make(*arguments):
    """Make a package in the current directory, and return the output."""
    return CliRunner().invoke(package, arguments, catch_exceptions=False).output


def files(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def files_of(name, module):
    own = (f"launch/{name}.launch.py", f"{name}/__init__.py", f"{name}/{module}.py", f"test/test_{module}.py")
    return COMMON | {*own, f"resource/{name}"}


def depends(folder):
    return {each.text for each in ElementTree.parse(folder / "package.xml").findall("exec_depend")}


def test_a_package_of_the_example(here):
    said = make("my_listener")
    folder = here / "my_listener"
    assert files(folder) == files_of("my_listener", "listener")
    assert (folder / "my_listener" / "listener.py").read_bytes() == (HOME / "notebooks" / "listener.py").read_bytes()
    assert depends(folder) == {"rclpy", "ros2launch", "sensor_msgs"}
    assert set(said.splitlines()) >= {"my_listener/package.xml", "    ros2 run my_listener listener"}


def test_interface_package(here):
    said = make("my_msgs", "--interfaces")
    folder = here / "my_msgs"
    assert files(folder) == {
        "CMakeLists.txt", "package.xml", "msg/Target.msg", "srv/FindTarget.srv", "action/AimAt.action"
    }  # fmt: skip
    assert ElementTree.parse(folder / "package.xml").findtext("maintainer") == ANN[0]
    assert "rosidl_generate_interfaces(${PROJECT_NAME}" in (folder / "CMakeLists.txt").read_text()
    assert set(said.splitlines()) >= {"my_msgs/msg/Target.msg", "    tank ros build my_msgs"}


@pytest.mark.parametrize("other", [["--controller", "mine.py"], ["--service"]])
def test_one_kind_of_package(here, other):
    assert "Give only one of" in make("my_msgs", "--interfaces", *other)
    assert not (here / "my_msgs").exists()


def test_a_package_with_a_service(here):
    said = make("my_server", "--service")
    folder = here / "my_server"
    assert files(folder) == files_of("my_server", "server")
    assert depends(folder) == {"rclpy", "ros2launch", "sensor_msgs", "std_srvs"}
    assert "    ros2 run my_server server\n" in said


def test_a_controllers_package_runs_its_first_step(here):
    said = make("my_tank", "--controller", "mine.py:JointStatePublisher", "--destination-directory", "src")
    folder = here / "src" / "my_tank"
    assert files(folder) == files_of("my_tank", "joint_state_publisher") | {"my_tank/node.py"}
    assert (folder / "my_tank" / "joint_state_publisher.py").read_text() == CONTROLLERS
    assert '"run", "step2", "--controller"' in (folder / "my_tank" / "node.py").read_text()
    assert 'name="simulation"' in (folder / "launch" / "my_tank.launch.py").read_text()
    assert "    ros2 run my_tank joint_state_publisher\n" in said


def test_a_viewers_package_declares_its_messages(here):
    source = (HOME / "tutorial" / "controllers" / "imu_subscriber.py").read_text(encoding="utf-8")
    (here / "mine.py").write_text(source + "\nimport geometry_msgs.msg as g\n", encoding="utf-8")
    make("my_viewer", "--controller", "mine.py")
    assert 'name="viewer"' in (here / "my_viewer" / "launch" / "my_viewer.launch.py").read_text()
    assert depends(here / "my_viewer") == {"geometry_msgs", "python3-numpy", "rclpy", "ros2launch", "sensor_msgs"}


def test_catkin_pkg_accepts_it(here):
    rep149 = pytest.importorskip("catkin_pkg.package", reason="catkin_pkg is not installed: make install installs it")
    make("my_tank", "--controller", "mine.py:TankController")
    complaints = []
    found = rep149.parse_package(str(here / "my_tank"), warnings=complaints)
    assert complaints == []
    assert (found.package_format, found.name, found.version) == (3, "my_tank", "0.0.0")
    assert found.get_build_type() == "ament_python"
    assert [(each.name, each.email) for each in found.maintainers] == [ANN]


@pytest.mark.process
def test_it_is_installed_where_ros2_looks_for_it(here):
    need_setuptools()
    make("my_listener")
    make("my_tank", "--controller", "mine.py:TankController")
    prefix = here / "install"
    for name in ("my_listener", "my_tank"):
        install(here / name, prefix)
        assert (prefix / "share" / "ament_index" / "resource_index" / "packages" / name).exists()
        assert files(prefix / "share" / name) == {"package.xml", f"launch/{name}.launch.py"}
    starts = (prefix / "lib" / "my_tank" / "tank_controller").read_text().splitlines()[0]
    assert starts == "#!/usr/bin/env python3"  # of the active environment, which has the tutorial
    assert (prefix / "lib" / "my_listener" / "listener").exists()


@pytest.mark.process
@pytest.mark.parametrize("arguments", [[], ["--controller", "mine.py:TankController"], ["--service"]])
def test_the_generated_test_passes(here, domain, arguments, backend):
    if backend == "pocket" and "--service" in arguments:
        pytest.skip("the pocket ROS 2 has no services")
    make("my_tank", *arguments)
    alone = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # Jazzy's plugins do not work with pytest 9
    assert "1 passed" in run("-m", "pytest", "-p", "tutorial", cwd=here / "my_tank", **alone)


@pytest.mark.process
def test_its_node_takes_the_options_of_tank_run(here, domain):
    make("my_tank", "--controller", "mine.py:JointStatePublisher")
    start = "import sys; from my_tank.node import main; main()"
    said = run("-c", start, "--headless", "--duration", "0.1", "--ros-args", "-r", "__node:=sim", cwd=here / "my_tank")
    assert "- TankController\n    - JointStatePublisher (joint_state_publisher.py)\n" in said
    assert "[sim]: mine publishes" in said


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("My-Tank", "'My-Tank' is not a valid package name. Did you mean 'my_tank'? Use at least two"),
        ("x", "at least two characters"),
        ("tank\x1b[2J", r"'tank\\x1b[2J' is not a valid package name"),
        ("lambda", "Python already has a module or keyword 'lambda'"),
        ("rclpy", "Choose a different name, such as 'my_rclpy'."),
    ],
)
def test_an_invalid_package_name_is_refused(here, name, said):
    with pytest.raises(TutorialError) as info:
        make(name)
    assert said.replace(r"\\", "\\") in str(info.value)
    assert files(here) == {"mine.py"}


def test_a_file_without_a_usable_class_is_refused(here):
    one = CONTROLLERS.partition("class J")[0]
    (here / "new.py").write_text(one.replace("class TankController", "class TankControl"))
    for controller, said in (
        ("mine.py", r"2 controllers\. Say which one: mine\.py:JointStatePublisher, mine\.py:TankController\."),
        ("new.py", r"no step has a controller named 'TankControl'\. Did you mean 'TankController'\?"),
    ):
        with pytest.raises(TutorialError, match=said):
            make("my_tank", "--controller", controller)
    assert not (here / "my_tank").exists()


def test_a_base_class_is_not_a_second_controller(here):
    helper = CONTROLLERS.partition("class J")[0].replace("class TankController", "class Helper")
    (here / "mine.py").write_text(f"{helper}class TankController(Helper):\n    pass\n")
    assert "ros2 run my_tank tank_controller" in make("my_tank", "--controller", "mine.py")


def test_existing_files_are_kept(here):
    (here / "my_tank").mkdir()
    (here / "my_tank" / "setup.py").write_text("mine")
    before = files(here)
    with pytest.raises(TutorialError, match="'my_tank' already exists and will not be overwritten"):
        make("my_tank")
    assert files(here) == before
    assert (here / "my_tank" / "setup.py").read_text() == "mine"


@pytest.mark.parametrize(("name", "email"), [("", ""), ("Ann", "ann@localhost"), ("A\bB", "a@b.cd")])
def test_an_unknown_maintainer_becomes_a_placeholder(here, monkeypatch, name, email):
    assert find_maintainer() == ANN
    monkeypatch.setattr(contents, "_ask_git", {"user.name": name, "user.email": email}.__getitem__)
    assert find_maintainer() == NOBODY


@pytest.mark.process
def test_git_may_be_missing(tmp_path, monkeypatch):
    (tmp_path / "gitconfig").write_text('[user]\nname = "Ann \\"A\\" <O\'Hara> & Son"\nemail = ann@example.com\n')
    monkeypatch.setenv("GIT_CONFIG_GLOBAL", str(tmp_path / "gitconfig"))
    monkeypatch.chdir(tmp_path)
    assert find_maintainer() == ANN
    monkeypatch.setenv("PATH", str(tmp_path))
    assert find_maintainer() == NOBODY
