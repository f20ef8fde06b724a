"""Importing a package that only a real ROS 2 has raises a helpful error. Existing packages are never hidden."""

import sys
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec

import pytest

import pocket_ros2

pytestmark = pytest.mark.pocket

MISSING = [
    "ament_index_python.packages",
    "control_msgs.msg",
    "cv_bridge",
    "example_interfaces.srv",
    "launch.substitutions",
    "launch_ros.actions",
    "message_filters",
    "rclpy.action",
    "rosbag2_py",
    "rosidl_runtime_py.utilities",
    "sensor_msgs.srv",
    "sensor_msgs_py.point_cloud2",
    "std_srvs.srv",
    "tf2_geometry_msgs",
    "tf2_ros.buffer",
    "tf2_msgs.action",
    "turtlesim.msg",
]


@pytest.fixture
def importing(monkeypatch, tmp_path):
    """Create a package in a folder on the path, and forget its import afterwards."""
    monkeypatch.syspath_prepend(tmp_path)
    made = []

    def make(name: str) -> None:
        made.append(name)
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text("HERE = True")

    yield make
    for name in made:
        sys.modules.pop(name, None)


class LateFinder(MetaPathFinder, Loader):
    """Finds ``cv_bridge``."""

    def find_spec(self, fullname, path, target=None):
        return ModuleSpec(fullname, self) if fullname == "cv_bridge" else None

    def exec_module(self, module):
        module.HERE = True


@pytest.mark.parametrize("name", MISSING)
def test_import(name):
    with pytest.raises(
        ModuleNotFoundError, match=r"has no [\w.]+\. Install a real ROS 2 Jazzy \(see https.*program\."
    ) as error:
        import_module(name)
    on_pypi = name.startswith(("rclpy", "std_srvs", "ament_index", "sensor_msgs.srv", "tf2_msgs.action"))
    assert str(error.value).endswith("tank ros install." if on_pypi else "program.")
    assert type(error.value).__name__ == "NeedsRealROSError"
    assert name.startswith(error.value.name)


@pytest.mark.parametrize("name", ["my_msgs.msg", "own_interfaces"])
def test_own_package(name):
    package = name.partition(".")[0]
    with pytest.raises(ModuleNotFoundError, match=f"has no {package}. With a real .* you can install this package, or"):
        import_module(name)


@pytest.mark.parametrize(
    "name",
    [
        *("numpyy", "my_common", "sensor_msgs.foo", "launch_helpers", "rclpy.graph_listener"),
        *("std_msgs.srv", "geometry_msgs.srv", "builtin_interfaces.srv", "sensor_msgs.action", "nav_msgs.action"),
    ],
)
def test_other_modules(name):
    with pytest.raises(ModuleNotFoundError, match=f"^No module named {name!r}$"):
        import_module(name)


@pytest.mark.parametrize("name", ["message_filters", "std_srvs", "example_interfaces", "my_msgs"])
def test_nothing_is_hidden(name, importing):
    importing(name)
    assert import_module(name).HERE


def test_later_finder(monkeypatch):
    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, LateFinder()])
    assert import_module("cv_bridge").HERE
    del sys.modules["cv_bridge"]


@pytest.mark.parametrize("name", ["cv_bridge", "std_srvs", "my_msgs", "rclpy.action", "launch.substitutions"])
def test_find_spec_finds_nothing(name):
    assert find_spec(name) is None


@pytest.mark.process
def test_program_without_rclpy(start):
    _, errors = start("import launch_ros.actions").communicate(timeout=60)
    assert errors.splitlines()[-1].startswith("rclpy.exceptions.NeedsRealROSError: The pocket ROS 2 has no launch_ros.")


def test_table():
    from _absent import TABLE
    from _rosidl.finder import InterfaceFinder

    missing = [*TABLE["packages"], *TABLE["modules"]]
    assert [name for name in missing if (pocket_ros2.PATH / f"{name.replace('.', '/')}.py").exists()] == []
    assert [name for name in missing if (pocket_ros2.PATH / name).exists()] == []
    assert [name for name in missing if InterfaceFinder().find_spec(name, None)] == []
    owners = {module: vars(import_module(module)) for module in TABLE["names"]}
    assert [name for module, names in TABLE["names"].items() for name in names if name in owners[module]] == []
