"""The folder with the real ROS 2: find it, check it, and make its rclpy importable.

If the wheels were installed into the environment itself, they would overwrite files in JupyterLab's ``lark`` package
and make every Python interpreter start twice. In a separate folder, they affect only programs that request them.
"""

import os
import platform
import sys
from pathlib import Path

from tutorial.errors import TutorialError
from tutorial.system.paths import PACKAGE, is_course

WHEELS = Path(__file__).with_name("runtime.txt")
"""List of the wheels in the folder, with versions and hashes."""

ABOUT = WHEELS.with_name("about.txt")
"""The file that describes these wheels to users."""

RMW = "rmw_fastrtps_cpp"
"""The only RMW among the wheels."""

PROFILES = "FASTRTPS_DEFAULT_PROFILES_FILE"
"""The environment variable for the path of the Fast DDS settings file."""

RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"

PYTHON = f"python{sys.version_info.major}.{sys.version_info.minor}"

TAG = f"cp{sys.version_info.major}{sys.version_info.minor}"
"""The tag of this Python version in the names of wheels; each folder is for one version of Python."""

COMPILER = f"g++ and Python.h: sudo apt install g++ {PYTHON}-dev, or on Fedora sudo dnf install gcc-c++ python3-devel."
"""Requirements for building an interface package, and how to install them."""

NO_TF2_MSGS = f"tf2_msgs is not built yet. Type tank ros install again after installing {COMPILER}"

NOT_ON_PYPI = ("example_interfaces", "launch", "launch_ros", "message_filters", "rosbag2_py", "tf2_ros", "turtlesim")
"""Packages that many programs import, but that the folder lacks."""


def prefix() -> Path:
    """Return the folder: in the checkout or, if the tutorial is installed, in the user's data folder."""
    if is_course(PACKAGE.parent):
        return PACKAGE.parent / ".ros2" / TAG
    given = Path(os.environ.get("XDG_DATA_HOME", ""))
    data = given if given.is_absolute() else Path.home() / ".local/share"
    return data / "tank-tutorial/ros2" / TAG


def site_packages(folder: Path) -> Path:
    """Return the subfolder that must be on Python's path."""
    return folder / "lib" / PYTHON / "site-packages"


def is_complete(folder: Path, wheels: Path = WHEELS) -> bool:
    """Return whether a folder contains all wheels in a list. The last step of an installation copies the list there."""
    copy = folder / wheels.name
    return copy.is_file() and copy.read_bytes() == wheels.read_bytes()


def state() -> str:
    """Return "installed", "out of date" or "not installed"."""
    if is_complete(prefix()):
        return "installed"
    return "out of date" if prefix().exists() else "not installed"


def check() -> None:
    """Raise an error if the folder cannot be used.

    Raises:
        TutorialError: the folder is incomplete, or it lacks the RMW that RMW_IMPLEMENTATION names.
    """
    if state() != "installed":
        raise TutorialError(f"the real ROS 2 in {prefix()} is {state()}. {how_to_get_it()}")
    rmw = os.environ.get("RMW_IMPLEMENTATION") or RMW
    if rmw != RMW:
        raise TutorialError(
            f"RMW_IMPLEMENTATION is {rmw!r}, but the ROS 2 in {prefix()} has only {RMW!r}. "
            "Type unset RMW_IMPLEMENTATION, or source a ROS 2 that has the other RMW."
        )


def activate() -> None:
    """Make ``import rclpy`` find the folder's rclpy in this process, and limit discovery to this machine.

    By default, a real ROS 2 discovers nodes throughout the local network, but a learner must not drive a neighbour's
    tank. Comments in `fastdds.xml` explain the Fast DDS settings. A user's own settings take precedence. Child
    processes inherit all settings.
    """
    sys.path.append(str(site_packages(prefix())))
    os.environ[RANGE] = os.environ.get(RANGE) or "LOCALHOST"
    os.environ[PROFILES] = os.environ.get(PROFILES) or str(WHEELS.with_name("fastdds.xml"))


def explain_missing(module: str) -> None:
    """Explain where to get a module that many programs import, but that the folder lacks.

    Raises:
        TutorialError: the folder lacks the module.
    """
    if module == "tf2_msgs":
        raise TutorialError(NO_TF2_MSGS)
    if module in NOT_ON_PYPI:
        others = "RoboStack and Ubuntu have packages for all of ROS 2: see book/real_ros2.md."
        raise TutorialError(f"the real ROS 2 from tank ros install has no {module}: it is not on PyPI. {others}")


def is_supported() -> bool:
    """Return whether PyPI has these wheels for this machine."""
    return (platform.system(), platform.machine()) == ("Linux", "x86_64")


def how_to_get_it() -> str:
    """Return a sentence that explains how to get a real ROS 2 on this machine."""
    if is_supported():
        return "Type tank ros install."
    ways = "pixi run lab installs ROS 2 from RoboStack"
    if platform.system() == "Linux":
        ways += ", Ubuntu 24.04 has apt packages, and a container can run with --platform linux/amd64"
    return f"PyPI has no ROS 2 for {platform.system()} on {platform.machine()}: {ways}. See book/real_ros2.md."
