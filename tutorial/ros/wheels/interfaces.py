"""Build interface packages, which define messages, services and actions, for the real ROS 2 of PyPI's wheels.

The packages are ordinary ones, which colcon builds unchanged. CMake and ROS 2's generators are also installed from
wheels, into the folder ``build`` of the real ROS 2's folder. `interfaces.cmake` has the settings for these folders.
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
from tutorial.ros.wheels.install import Report, alone, fill, last_line, run

HERE = Path(__file__).parent
TOOLS = HERE / "build.txt"
"""What an interface package is built with: each wheel with its version and its hashes."""

TF2_MSGS = HERE / "tf2_msgs"
"""The source of tf2_msgs, which PyPI lacks."""

TF2_MSGS_WHEEL = HERE / "tf2_msgs.txt"
"""The requirement of the wheel that is built from it, with hashes; only in a release."""

FOREIGN = ("AMENT_", "CMAKE_", "COLCON_", "DESTDIR", "LD_", "PYTHON")
"""Prefixes of environment variables that would lead the build to another ROS 2 or another Python."""


LONGEST = 500  # [characters] of CMake's error message


def build_interfaces(source: Path, prefix: Path, report: Report) -> str:
    """Build an interface package, and install it into the folder of the real ROS 2; return the package's name.

    Building a package again replaces it. Nothing is installed before everything is built.

    Args:
        source: the package's folder.
        prefix: the folder of the real ROS 2, complete.
        report: called repeatedly with the progress.

    Raises:
        TutorialError: the folder is not an interface package's, or the build failed; the text says what to do.
    """
    name = _read_name(source)
    with alone(prefix):
        _check_free(name, prefix)
        _build(source.resolve(), name, prefix.resolve(), report)
    return name


def install_tf2_msgs(prefix: Path, report: Report) -> None:
    """Install tf2_msgs: in a release from its wheel, otherwise from source if there is a compiler.

    Args:
        prefix: the folder of the real ROS 2, complete.
        report: called repeatedly with the progress.

    Raises:
        TutorialError: something went wrong; the text says what to do.
    """
    with alone(prefix):
        if (folder.site_packages(prefix) / TF2_MSGS.name).exists():
            return
        if TF2_MSGS_WHEEL.exists():
            part = prefix / "tf2_msgs.part"
            wheel = part / "new"
            fill(wheel, TF2_MSGS_WHEEL, part, report)
            _move(TF2_MSGS.name, wheel, prefix)
            shutil.rmtree(part)
        elif not missing_compiler():
            _build(TF2_MSGS, TF2_MSGS.name, prefix.resolve(), report)


def missing_compiler() -> str:
    """Return what this machine lacks to build an interface package, and how to get it; empty if nothing is missing."""
    if not all(any(map(shutil.which, names)) for names in (("cc", "gcc", "clang"), ("c++", "g++", "clang++"))):
        return "there is no C++ compiler. Install one: sudo apt install g++, or on Fedora sudo dnf install gcc-c++."
    header = Path(sysconfig.get_path("include"), "Python.h")
    if not header.exists():
        package = f"python{sys.version_info.major}.{sys.version_info.minor}-dev"
        ways = f"sudo apt install {package}, or on Fedora sudo dnf install python3-devel"
        return f"this Python's headers are missing: there is no {header}. Install them: {ways}."
    return ""


def _read_name(source: Path) -> str:
    """Read the name of an interface package.

    Raises:
        TutorialError: it is not such a package.
    """
    try:
        name = ElementTree.parse(source / "package.xml").findtext("name", "").strip()
        if "rosidl_generate_interfaces" in (source / "CMakeLists.txt").read_text(encoding="utf-8"):
            return name
    except (OSError, UnicodeDecodeError, ElementTree.ParseError) as error:
        what = f": {error}" if isinstance(error, OSError) else f": package.xml: {error}"
    else:
        what = ": its CMakeLists.txt does not call rosidl_generate_interfaces"
    how = "tank package --interfaces my_msgs makes one."
    raise TutorialError(f"{str(source)!r} is not the folder of an interface package{what}. {how}")


def _check_free(name: str, prefix: Path) -> None:
    """Check that a package does not hide another one.

    Raises:
        TutorialError: it cannot have this name.
    """
    site = folder.site_packages(prefix)
    if name == TF2_MSGS.name or any(site.glob(f"ros_{name}-*.dist-info")):
        raise TutorialError(f"ROS 2 has a package {name!r} already. Call yours {f'my_{name}'!r}, for instance.")
    was_built_before = VALID.fullmatch(name) and (site / name).exists()
    if not was_built_before:
        check_package_name(name)


def _build(source: Path, name: str, prefix: Path, report: Report) -> None:
    """Build a package, and move it into the folder.

    Raises:
        TutorialError: it could not be built.
    """
    if missing := missing_compiler():
        raise TutorialError(missing)
    tools = _tools(prefix, report)
    scratch = tools / "scratch"
    shutil.rmtree(scratch, ignore_errors=True)  # what a killed build left behind
    with TemporaryDirectory(prefix="tank-") as elsewhere:
        build = scratch / "build" if str(scratch).isascii() else Path(elsewhere)  # CMake's file(STRINGS) skips the rest
        try:
            _run_cmake(source, name, prefix, tools, build, report)
            _move(name, scratch / "install", prefix)
        finally:
            shutil.rmtree(scratch, ignore_errors=True)


def _tools(prefix: Path, report: Report) -> Path:
    """Return the folder of CMake and the generators; fill it the first time.

    Raises:
        TutorialError: it could not be filled.
    """
    tools, part = prefix / "build", prefix / "build.part"
    copy = tools / TOOLS.name
    if not copy.is_file() or copy.read_bytes() != TOOLS.read_bytes():
        new = part / "new"
        for stale in (tools, new):
            shutil.rmtree(stale, ignore_errors=True)
        fill(new, TOOLS, part, report)
        shutil.copy(TOOLS, new)
        new.rename(tools)
        shutil.rmtree(part)
    return tools


def _run_cmake(source: Path, name: str, prefix: Path, tools: Path, build: Path, report: Report) -> None:
    """Configure a package, build it in a folder, and install it into ``scratch/install``.

    Raises:
        TutorialError: it could not be built.
    """
    cmake = folder.site_packages(tools) / "cmake/data/bin/cmake"
    settings = {
        "BUILD_TESTING": "OFF",
        "CMAKE_INSTALL_PREFIX": tools / "scratch/install",
        "CMAKE_MAKE_PROGRAM": tools / "bin/ninja",
        "CMAKE_PROJECT_INCLUDE": HERE / "interfaces.cmake",
        "PYTHON_EXECUTABLE": sys.executable,
        "Python3_EXECUTABLE": sys.executable,
    }
    options = [f"-D{setting}={value}" for setting, value in settings.items()]
    environment = _environment(prefix, tools)
    for words in (
        ["-S", source, "-B", build, "-G", "Ninja", *options],
        ["--build", build],
        ["--install", build, "--strip"],
    ):
        status, output = run(
            [str(cmake), *map(str, words)], lambda line: report(f"building {name}{_how_far(line)}"), environment
        )
        if status:
            raise TutorialError(f"{name} could not be built: {_explain(output, source, name, prefix, environment)}")


def _environment(prefix: Path, tools: Path) -> dict[str, str]:
    """Return the environment variables of a process that finds both folders and no other ROS 2."""
    own = {variable: value for variable, value in os.environ.items() if not variable.startswith(FOREIGN)}
    folders = (tools, prefix)
    path = os.pathsep.join(map(str, folders))
    modules = os.pathsep.join(str(folder.site_packages(each)) for each in folders)
    return own | {"AMENT_PREFIX_PATH": path, "CMAKE_PREFIX_PATH": path, "PYTHONPATH": modules}


def _how_far(line: str) -> str:
    """Return the progress that a line of ninja shows, such as ``[3/56] Generating C code``; empty for other lines."""
    steps = re.match(r"\[(\d+)/(\d+)\]", line)
    return f": {steps[1]} of {steps[2]} steps" if steps else ""


def _explain(output: str, source: Path, name: str, prefix: Path, environment: dict[str, str]) -> str:
    """Return why a build failed, in a sentence or in the words of the tool that failed."""
    if "No space left on device" in output:
        return f"the disk of {prefix} is full. Free 200 MB, and try again."
    files = sorted(str(file) for kind in ("msg", "srv", "action") for file in source.glob(f"{kind}/*.{kind}"))
    check = [sys.executable, str(HERE / "definitions.py"), name, str(prefix), *files]
    status, mistake = run(check, environment=environment)
    if mistake and status == 0:
        return f"{mistake}."
    if missing := re.search(r'configuration file provided by\s+"(\w+)"', output):
        return f"there is no package {missing[1]!r}. Correct its name, or build it first, with tank ros build."
    if error := re.search(r"CMake Error.*?(?=\n\n\n|Call Stack|\Z)", output, re.DOTALL):
        return shorten(error[0], LONGEST)
    errors = [line for line in output.splitlines() if re.search(r"\b[eE]rror: |Error: ", line)]
    return f"{errors[0] if errors else last_line(output)}."


def _move(name: str, built: Path, prefix: Path) -> None:
    """Move a package into the folder; the Python package last, so that what can be imported is complete."""
    package = folder.site_packages(built) / name
    old = built.with_name("old")
    old.mkdir()
    for part in (package, built / "include" / name, built / "share" / name):
        place = prefix / part.relative_to(built)
        if place.exists():
            place.rename(old / part.parent.name)
    for cache in package.rglob("__pycache__"):  # it contains paths of the build folder
        shutil.rmtree(cache)
    for top in ("include", "lib", "share"):
        for file in (each for each in (built / top).rglob("*") if each.is_file() and package not in each.parents):
            place = prefix / file.relative_to(built)
            place.parent.mkdir(parents=True, exist_ok=True)
            file.replace(place)
    package.rename(prefix / package.relative_to(built))
    shutil.rmtree(old)
