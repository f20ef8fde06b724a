"""The folder of the real ROS 2: its place, and whether it can be used."""

import os
import re

import pytest

from tutorial.errors import TutorialError
from tutorial.ros.wheels import folder

SETTINGS = folder.WHEELS.with_name("fastdds.xml")


@pytest.fixture
def place(tmp_path, monkeypatch):
    """An empty folder in place of the real one."""
    monkeypatch.setattr(folder, "prefix", lambda: tmp_path)
    for name in ("RMW_IMPLEMENTATION", folder.RANGE, folder.PROFILES):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


def test_folder_of_a_checkout():
    assert folder.prefix() == folder.PACKAGE.parent / ".ros2" / folder.TAG


def test_folder_without_a_checkout(tmp_path, monkeypatch):
    monkeypatch.setattr(folder, "PACKAGE", tmp_path / "tutorial")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert folder.prefix() == tmp_path / "tank-tutorial/ros2" / folder.TAG


@pytest.mark.parametrize("content", [None, b"of last year"])
def test_incomplete_folder(place, monkeypatch, content):
    monkeypatch.setattr(folder.platform, "system", lambda: "Linux")
    monkeypatch.setattr(folder.platform, "machine", lambda: "x86_64")
    if content is not None:
        (place / folder.WHEELS.name).write_bytes(content)
    with pytest.raises(TutorialError, match=r"is out of date\. Type tank ros install\."):
        folder.check()


def test_other_rmw(place, monkeypatch):
    (place / folder.WHEELS.name).write_bytes(folder.WHEELS.read_bytes())
    for harmless in ("", folder.RMW):
        monkeypatch.setenv("RMW_IMPLEMENTATION", harmless)
        folder.check()
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")
    with pytest.raises(TutorialError, match=r"has only 'rmw_fastrtps_cpp'\. Type unset RMW_IMPLEMENTATION"):
        folder.check()


@pytest.mark.parametrize(("name", "usual"), [(folder.RANGE, "LOCALHOST"), (folder.PROFILES, str(SETTINGS))])
def test_the_users_settings_win(place, monkeypatch, name, usual):
    monkeypatch.setattr(folder.sys, "path", [])
    for given, used in (("", usual), ("mine", "mine")):
        monkeypatch.setenv(name, given)
        folder.activate()
        assert os.environ[name] == used
    assert "<intraprocess_delivery>OFF<" in SETTINGS.read_text()


@pytest.mark.parametrize(
    ("system", "machine", "said"),
    [
        ("Linux", "x86_64", "Type tank ros install."),
        ("Linux", "aarch64", "no ROS 2 for Linux on aarch64: pixi run lab .*apt.*--platform linux/amd64"),
        ("Darwin", "arm64", r"no ROS 2 for Darwin on arm64: pixi run lab installs ROS 2 from RoboStack\. See"),
    ],
)
def test_how_to_get_it(monkeypatch, system, machine, said):
    monkeypatch.setattr(folder.platform, "system", lambda: system)
    monkeypatch.setattr(folder.platform, "machine", lambda: machine)
    assert re.search(said, folder.how_to_get_it())
