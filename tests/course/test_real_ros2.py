"""What is said about a real ROS 2: the list of its packages, and the pages about it and about two machines."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet

from tutorial.commands.doctor.finding import layout
from tutorial.commands.doctor.ros import backend
from tutorial.commands.tank import tank

HOME = Path(__file__).parents[2]
PAGES = [HOME / "book" / "real_ros2.md", HOME / "book" / "two_machines.md"]


@pytest.fixture(scope="module")
def pixi():
    return tomllib.loads((HOME / "pixi.toml").read_text())


@pytest.fixture(scope="module")
def project():
    return tomllib.loads((HOME / "pyproject.toml").read_text())["project"]


def test_its_python_is_one_of_the_tutorials(pixi, project):
    minor = re.fullmatch(r"(3\.\d+)\.\*", pixi["dependencies"]["python"])[1]
    assert f"{minor}.0" in SpecifierSet(project["requires-python"])


def test_what_both_require_can_be_had_at_once(pixi, project):
    wanted = {each.name: each.specifier for each in map(Requirement, project["dependencies"])}
    both = {name: spec for name, spec in pixi["dependencies"].items() if name in wanted}
    assert both
    for name, specifier in both.items():
        assert SpecifierSet(specifier) == wanted[name], name


def test_ros_comes_from_robostack(pixi):
    assert pixi["workspace"]["channels"] == ["robostack-jazzy", "conda-forge"]
    names = [name for name in pixi["dependencies"] if name.startswith("ros")]
    assert {"ros-jazzy-rclpy", "ros-jazzy-rmw-cyclonedds-cpp", "ros-jazzy-ros2topic"} <= set(names)
    assert all(name.startswith("ros-jazzy-") for name in names)


def test_every_message_package_that_the_tutorial_imports_is_listed(pixi):
    sources = [
        path
        for folder in ("controllers", "notebook", "notebook/widgets")
        for path in (HOME / "tutorial" / folder).glob("*.py")
    ]
    imported = {
        name for path in sources for name in re.findall(r"^from (\w+_msgs)\.msg", path.read_text(), re.MULTILINE)
    }
    assert imported
    assert {f"ros-jazzy-{name.replace('_', '-')}" for name in imported} <= set(pixi["dependencies"])


def test_the_tutorial_itself_is_installed_as_it_lies_here(pixi, project):
    ((name, how),) = pixi["pypi-dependencies"].items()
    assert name == project["name"]
    assert (HOME / how["path"] / "pyproject.toml").samefile(HOME / "pyproject.toml")
    assert how["editable"]
    assert set(how["extras"]) <= set(project["optional-dependencies"])


def test_its_tasks_are_commands_that_there_are(pixi):
    assert {"demo", "lab", "test"} <= set(pixi["tasks"])
    for command in pixi["tasks"].values():
        program, verb, *_ = command.split()
        assert (program, verb) == ("python", "-m") or (program == "tank" and verb in tank.commands)


@pytest.mark.parametrize("path", [HOME / "pixi.toml", *PAGES], ids=lambda path: path.name)
def test_no_host_is_named(path):
    assert "://" not in path.read_text()


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_the_commands_on_a_page_are_commands_that_there_are(path):
    typed = re.findall(r"^\$ (?:\w+=\S+ )*tank (\w+)(?: (\w+))?", path.read_text(), re.MULTILINE)
    mentioned = re.findall(r"`tank (\w+)(?: (\w+))?", path.read_text())
    assert typed
    for verb, further in typed + mentioned:
        assert verb in tank.commands
        assert not hasattr(tank.commands[verb], "commands") or further in tank.commands[verb].commands


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_the_links_on_a_page_lead_somewhere(path):
    text = path.read_text()
    for target in re.findall(r"\]\(([^)]+)\)", text):
        is_there = f"({target[1:]})=" in text if target.startswith("#") else (path.parent / target).exists()
        assert is_there, target


def test_tasks_that_a_page_names_are_there(pixi):
    named = re.findall(r"^\$ pixi run (\w+)", PAGES[0].read_text(), re.MULTILINE)
    assert set(named) == set(pixi["tasks"])


def test_what_a_page_shows_of_the_doctor_is_what_it_says():
    found = {
        "version": "7.1.3",
        "file": "/opt/ros/jazzy/lib/python3.12/site-packages/rclpy/__init__.py",
        "rmw": "rmw_fastrtps_cpp",
    }
    (finding,) = backend({"ROS_DISTRO": "jazzy"}, lambda: "rclpy", lambda: True, lambda *_: found)
    assert layout(finding) in PAGES[0].read_text()


def test_the_ports_of_the_table_are_those_of_the_formula():
    text = PAGES[1].read_text()
    rows = re.findall(r"^\| (\d+) \| (\d+):(\d+) \|$", text, re.MULTILINE)
    assert len(rows) == 4
    for domain, first, last in rows:
        assert int(first) == 7400 + 250 * int(domain)
        assert int(last) == int(first) + 249
    assert "11650:11899" in text.partition("ufw allow")[2].partition("\n")[0]
