"""Which ROS 2 a process uses, and the error if it cannot use the requested one."""

import os
import subprocess
import sys
from importlib.machinery import EXTENSION_SUFFIXES

import pytest

from tutorial.errors import TutorialError
from tutorial.ros.backend import _check_version

OURS = f"{sys.version_info.major}.{sys.version_info.minor}"
START = """
import os, shutil
from pathlib import Path
from tutorial import use_real_ros
from tutorial.ros.backend import promise, ros_backend
from tutorial.ros.wheels import folder
made = Path({made!r})
ros_backend.cache_clear()
folder.prefix = lambda: made
"""
"""The first lines of a program that uses a separate folder for the real ROS 2."""


@pytest.fixture
def rclpy(tmp_path):
    """The folder of an rclpy for Python 3.10, whose compiled part cannot be imported here."""
    package = tmp_path / "lib/python3.10/site-packages/rclpy"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("from rclpy import _rclpy_pybind11")
    (package / "_rclpy_pybind11.cpython-310-x86_64-linux-gnu.so").touch()
    return package


def test_rclpy_for_another_python(rclpy):
    with pytest.raises(
        TutorialError, match=rf"python3\.10/.* is for a different Python version than .*, python{OURS}\. .*=pocket"
    ):
        _check_version(rclpy)


def test_rclpy_for_this_python(rclpy):
    (rclpy / f"_rclpy_pybind11{EXTENSION_SUFFIXES[0]}").touch()
    _check_version(rclpy)


def run(code, **variables):
    """Run a program in a new process, and return the last line of its output or error."""
    environment = {name: value for name, value in os.environ.items() if name != "TUTORIAL_ROS"} | variables
    ended = subprocess.run([sys.executable, "-c", code], env=environment, check=False, capture_output=True, text=True)
    return (ended.stdout + ended.stderr).splitlines()[-1]


@pytest.mark.process
@pytest.mark.parametrize(
    "code",
    [
        "import tutorial, rclpy",
        "import tutorial; from sensor_msgs.msg import JointState",
        "import tutorial.notebook",
        "from tutorial.__main__ import main; main(['topic', 'list'])",
        "from tutorial.__main__ import main; main(['run', 'step2', '--headless', '--duration', '1'])",
        "from tutorial.__main__ import main; main(['demo', '--headless', '--duration', '1'])",
        "from tutorial.__main__ import main; main(['joy', '--duration', '1'])",
    ],
)
def test_every_entry_point_reports_it(rclpy, code):
    said = run(code, PYTHONPATH=str(rclpy.parent))
    assert "is for a different Python version" in said
    assert "step2.yaml" not in said


@pytest.mark.process
@pytest.mark.pocket
@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("use_real_ros(); import rclpy; print(rclpy.__file__)", "made/lib/"),
        ("use_real_ros(); print(os.environ['TUTORIAL_ROS'], os.environ[folder.RANGE])", "rclpy LOCALHOST"),
        ("import rclpy; use_real_ros()", "the pocket ROS 2 is already in use"),
        ("from std_msgs.msg import String; use_real_ros()", "restart the kernel"),
        ("(made / 'runtime.txt').write_text('older'); use_real_ros()", "out of date. Type tank ros install."),
        ("shutil.rmtree(made); use_real_ros()", "not installed. Type tank ros install."),
        ("os.environ['RMW_IMPLEMENTATION'] = 'rmw_x'; use_real_ros()", "has only 'rmw_fastrtps_cpp'"),
        (
            "use_real_ros(); from tf2_msgs.msg import TFMessage",
            "Type tank ros install again after installing g++ and Python.h",
        ),
        ("use_real_ros(); import tf2_ros", "RoboStack and Ubuntu have packages for all of ROS 2"),
        ("os.environ['TUTORIAL_ROS'] = 'x'; promise(); use_real_ros(); import rclpy; print('found')", "found"),
    ],
)
def test_use_real_ros(tmp_path, code, said):
    from tutorial.ros.wheels import folder

    made = tmp_path / "made"
    package = folder.site_packages(made) / "rclpy"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / f"_rclpy_pybind11{EXTENSION_SUFFIXES[0]}").touch()
    (made / "runtime.txt").write_bytes(folder.WHEELS.read_bytes())
    assert said in run(f"{START.format(made=str(made))}{code}")


@pytest.mark.process
@pytest.mark.pocket
def test_pocket_after_a_refusal(tmp_path):
    refused = (
        "try: use_real_ros()\nexcept Exception: import rclpy; print(os.environ.get('TUTORIAL_ROS'), rclpy.__file__)"
    )
    assert run(START.format(made=str(tmp_path)) + refused).startswith("None ")
