"""The name, maintainer and files of a generated ROS 2 package."""

import re
import subprocess
from collections.abc import Mapping
from importlib.util import decode_source
from pathlib import Path
from string import Template
from xml.sax.saxutils import escape

from tutorial.errors import TutorialError, did_you_mean
from tutorial.program.controller_files import controller_names, load_controllers
from tutorial.program.project import Project
from tutorial.ros.package_names import check_package_name
from tutorial.system.paths import HOME, PACKAGE, find_home

TEMPLATES = Path(__file__).parent / "template"
EMAIL = re.compile(r"[\w%+-]+(\.[\w%+-]+)*@[A-Za-z0-9-]+(\.[A-Za-z0-9-]+)*\.[A-Za-z]{2,}", re.ASCII)
"""An email address, as accepted by catkin_pkg, colcon's parser for package.xml."""
IMPORTED = re.compile(r"^\s*(?:from|import)\s+(\w+)", re.MULTILINE)
"""Matches an import statement; the group is the imported top-level module."""
DEPENDENCIES = {"cv2": "python3-opencv", "numpy": "python3-numpy", "tf2_ros": "tf2_ros_py", "yaml": "python3-yaml"}
"""The rosdep keys for modules whose package has a different name. Message modules are named after their packages."""
NOBODY = ("Your Name", "you@example.com")
"""The name and email address of a placeholder maintainer; the learner has to replace both."""


def make_package(
    name: str, controller: tuple[Path, str | None] | None, example: str = "listener"
) -> tuple[dict[str, bytes], str]:
    """Make a package that contains the given controller or, by default, an example node.

    Args:
        name: the package's name.
        controller: the controller's Python file and class name; None instead of the name if the file defines only one.
        example: ``"listener"``, the first node in step 1's notebook, or ``"server"``, which offers a service.

    Returns:
        The content of each file, keyed by the file's path within the package; and the name of the executable.

    Raises:
        TutorialError: the name is invalid, the controller is missing, or no step has a controller with that name.
    """
    check_package_name(name)
    if controller is None:
        code = (find_home(PACKAGE) / "notebooks" / f"{example}.py").read_bytes()
        words = {"module": example, "main": example, "node": example, "description": _EXAMPLES[example]}
        kind = example
    else:
        kind, words, code = "controller", _controller(*controller), controller[0].read_bytes()
    maintainer, email = find_maintainer()
    modules = set(IMPORTED.findall(decode_source(code)))
    messages = {module for module in modules if module.endswith(("_msgs", "_interfaces", "_srvs"))}
    others = {DEPENDENCIES[module] for module in modules & DEPENDENCIES.keys()}
    needs = sorted({"rclpy", "ros2launch"} | messages | others)
    words = {
        **words,
        "package": name,
        "depends": "\n".join(f"  <exec_depend>{each}</exec_depend>" for each in needs),
        "maintainer": escape(maintainer),
        "quoted_maintainer": repr(maintainer),
        "email": email,
    }
    files = {
        "README.md": _filled(f"{kind}/README.md.in", words),
        "package.xml": _filled("package.xml.in", words),
        "setup.cfg": _filled(f"{kind}/setup.cfg.in", words),
        "setup.py": _filled("setup.py.in", words),
        f"resource/{name}": b"",
        f"{name}/__init__.py": b"",
        f"{name}/{words['module']}.py": code,
        f"launch/{name}.launch.py": _filled("launch.py.in", words),
        f"test/test_{words['module']}.py": _filled(f"{kind}/test.py.in", words),
    }
    if controller is not None:
        files[f"{name}/node.py"] = _filled("controller/node.py.in", words)
    return files, words["module"]


def make_interfaces(name: str) -> dict[str, bytes]:
    """Make a package with a message, a service and an action as examples.

    Args:
        name: the package's name.

    Returns:
        The content of each file, keyed by the file's path within the package.

    Raises:
        TutorialError: the name is not allowed for a package.
    """
    check_package_name(name)
    maintainer, email = find_maintainer()
    words = {"package": name, "maintainer": escape(maintainer), "email": email}
    files = ("CMakeLists.txt", "package.xml", "msg/Target.msg", "srv/FindTarget.srv", "action/AimAt.action")
    return {file: _filled(f"interfaces/{file}.in", words) for file in files}


def _filled(template: str, words: Mapping[str, str]) -> bytes:
    """Return a template with its variables filled in."""
    return Template((TEMPLATES / template).read_text(encoding="utf-8")).substitute(words).encode()


def find_maintainer() -> tuple[str, str]:
    """Return the user's name and email from git; `NOBODY` if either is missing or not allowed in package.xml."""
    name, email = _ask_git("user.name"), _ask_git("user.email")
    return (name, email) if name.isprintable() and name and EMAIL.fullmatch(email) else NOBODY


_EXAMPLES = {
    "listener": "A node that listens to the tank's joint states and logs the positions once a second.",
    "server": "A node that listens to the tank's joint states and offers a service that returns the positions.",
}
"""The descriptions of the examples, by module."""


def _controller(file: Path, only: str | None) -> dict[str, str]:
    """Return the template variables for a controller that replaces the course's controller of the same name.

    Args:
        file: the Python file that defines the controller.
        only: the name of the controller's class; None if the file defines only one controller.

    Raises:
        TutorialError: the file is missing, raises an exception, or does not define exactly one such controller; or no
            project in the course has a controller with this name.
    """
    found = load_controllers(file, only)
    bases = {base for controller in found.values() for base in controller.__mro__[1:]}
    names = [name for name, controller in found.items() if controller not in bases]
    if len(names) > 1:
        which = ", ".join(f"{file}:{name}" for name in sorted(names))
        raise TutorialError(f"{file} defines {len(names)} controllers. Say which one: {which}.")
    (name,) = names
    project = _project_for(name)
    return {
        "module": controller_names()[name].rpartition(".")[2],
        "main": "node",
        "node": "viewer" if project.time_step is None else "simulation",
        "controller": name,
        "project": project.path.stem,
        "description": "A controller for the tank in the tank tutorial.",
    }


def _project_for(name: str) -> Project:
    """Find the first project in the course that has a controller with this name.

    Raises:
        TutorialError: no project has such a controller.
    """
    known: set[str] = set()
    for path in sorted((HOME / "project").glob("step*.yaml"), key=lambda path: (len(path.stem), path.stem)):
        try:
            project = Project.load(path)
        except TutorialError:  # step 10 and a user's own TankServer need a real ROS 2
            continue
        names = {each.__name__ for item in project.bodies for each in item.controllers}
        if name in names:
            return project
        known |= names
    fix = "Give your class the name of the controller that it should replace."
    raise TutorialError(f"no step has a controller named {name!r}.{did_you_mean(name, known)} {fix}")


def _ask_git(setting: str) -> str:
    try:
        return subprocess.run(["git", "config", setting], capture_output=True, text=True, check=False).stdout.strip()
    except OSError:  # git is not installed
        return ""
