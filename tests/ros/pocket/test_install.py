"""The choice of rclpy: a real one if there is one, otherwise the pocket ROS 2."""

import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

import pocket_ros2


@pytest.fixture
def real(monkeypatch, tmp_path):
    """A broken rclpy that is installed, while Python forgets the one in use."""
    for name in [name for name in sys.modules if name.split(".")[0] == "rclpy"]:
        monkeypatch.delitem(sys.modules, name)
    others = [entry for entry in sys.path if entry != str(pocket_ros2.PATH)]
    monkeypatch.setattr(sys, "path", [str(tmp_path), *others])  # syspath_prepend would restore the shorter path
    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path])
    (tmp_path / "rclpy").mkdir()
    (tmp_path / "rclpy/__init__.py").write_text("raise ImportError('libcrypto is missing')")
    return tmp_path / "rclpy"


def test_a_real_one_wins_and_raises_its_own_error(real):
    before = [*sys.path]
    assert not pocket_ros2.install()
    assert sys.path == before
    with pytest.raises(ImportError, match="libcrypto is missing"):
        import_module("rclpy")


def test_the_pocket_ros_2_can_come_first(real):
    assert pocket_ros2.install(first=True)
    assert Path(find_spec("rclpy").origin).is_relative_to(pocket_ros2.PATH)


@pytest.mark.pocket
def test_a_folder_named_rclpy_is_ignored(real):
    (real / "__init__.py").unlink()
    assert pocket_ros2.install()
    assert sys.path[-1] == str(pocket_ros2.PATH)
