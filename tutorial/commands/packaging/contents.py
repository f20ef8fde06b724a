"""What a package is called, who maintains it, and what its files hold."""

from __future__ import annotations

import ast
import re
import subprocess
from collections.abc import Mapping
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path
from string import Template
from typing import NamedTuple
from xml.sax.saxutils import escape

from tutorial.controller_files import controller_names, load_controllers
from tutorial.errors import TutorialError, did_you_mean
from tutorial.paths import HOME, PACKAGE, find_home
from tutorial.project import Project

__all__ = ["NOBODY", "Maintainer", "Package", "find_maintainer", "make_package"]

TEMPLATES = Path(__file__).parent / "template"
ROS_MODULES = ("_msgs", "_interfaces", "_srvs")
"""How the Python modules of ROS 2 packages end that a node sends messages of."""
VALID = re.compile(r"[a-z](_?[a-z0-9])+")
"""What ROS 2 takes for a package's name: REP 144."""
EMAIL = re.compile(r"[\w%+-]+(\.[\w%+-]+)*@[A-Za-z0-9-]+(\.[A-Za-z0-9-]+)*\.[A-Za-z]{2,}", re.ASCII)
"""What catkin_pkg, with which colcon reads a package.xml, takes for an address."""


class Maintainer(NamedTuple):
    """A person with an address for mail."""

    name: str
    email: str


NOBODY = Maintainer("Your Name", "you@example.com")
"""Who stands there until the learner writes a name in its place."""


class Package(NamedTuple):
    """A package that is not written yet.

    Attributes:
        files: what each file holds, by its path within the package.
        executable: what its node is started by.
        blanks: what the learner has to fill in.
    """

    files: Mapping[str, bytes]
    executable: str
    blanks: str


class Node(NamedTuple):
    """What the package is made around: the node, and the code in which the learner goes on.

    Attributes:
        kind: the folder of its templates, ``listener`` or ``controller``.
        module: the module that holds the code; the executable is called like it.
        code: what stands in it.
        main: the module whose ``main()`` is the executable.
        words: what else stands in its templates.
    """

    kind: str
    module: str
    code: bytes
    main: str
    words: Mapping[str, str]


def _check_name(name: str) -> None:
    """Check that a package can have a name: it follows REP 144, and no Python module has it yet.

    Raises:
        TutorialError: it cannot; the text says a name that is near.
    """
    if not VALID.fullmatch(name):
        rule = "Use lowercase letters, digits and single _, a letter first, and two characters at least."
        raise TutorialError(f"{name!r} cannot be a package's name.{_nearest(name)} {rule}")
    if iskeyword(name) or find_spec(name) is not None:
        mend = f"Take another name, such as {f'my_{name}'!r}."
        raise TutorialError(f"Python has a module, or a keyword, {name!r} already: one would hide the other. {mend}")


def find_maintainer() -> Maintainer:
    """Ask git who works here; `NOBODY`, where it does not know, or what it says can stand in no package.xml."""
    found = Maintainer(_ask_git("user.name"), _ask_git("user.email"))
    return found if found.name.isprintable() and found.name and EMAIL.fullmatch(found.email) else NOBODY


def _example_node() -> Node:
    """A node without the course, the last of step 3's notebook."""
    code = (find_home(PACKAGE) / "notebooks" / "listener.py").read_bytes()
    description = "A node that listens to the tank's joints, and says once a second where they are."
    return Node("listener", "listener", code, "listener", {"node": "listener", "description": description})


def _controller_node(file: Path, only: str | None) -> Node:
    """A node that runs a controller in the place of the course's own of the same name.

    Args:
        file: the Python file that defines it.
        only: the name of its class; None for the only one that there is.

    Raises:
        TutorialError: the file is missing or fails, it defines several controllers, or none of this name, or no project
            of the course has one of this name.
    """
    found = load_controllers(file, only)
    bases = {base for controller in found.values() for base in controller.__mro__[1:]}
    names = [name for name, controller in found.items() if controller not in bases]
    if len(names) > 1:
        which = ", ".join(f"{file}:{name}" for name in sorted(names))
        raise TutorialError(f"{file} defines {len(names)} controllers. Say which one: {which}.")
    (name,) = names
    project = _project_for(name)
    module = controller_names()[name].rpartition(".")[2]
    words = {
        "node": "viewer" if project.time_step is None else "simulation",
        "controller": name,
        "project": project.path.stem,
        "description": "A controller for the tank of the tank tutorial.",
    }
    return Node("controller", module, file.read_bytes(), "node", words)


def make_package(name: str, controller: tuple[Path, str | None] | None) -> Package:
    """Make a package around a controller, or around the example.

    Args:
        name: the package's.
        controller: the Python file that defines it, and its class's name; None for the only one there.

    Raises:
        TutorialError: a package cannot be called so, or the controller is not there.
    """
    _check_name(name)
    node = _example_node() if controller is None else _controller_node(*controller)
    maintainer = find_maintainer()
    words = {
        **node.words,
        "package": name,
        "module": node.module,
        "main": node.main,
        "depends": "\n".join(f"  <exec_depend>{each}</exec_depend>" for each in _needs(node.code)),
        "maintainer": escape(maintainer.name),
        "quoted_maintainer": repr(maintainer.name),
        "email": maintainer.email,
    }

    def filled(template: str) -> bytes:
        return Template((TEMPLATES / template).read_text(encoding="utf-8")).substitute(words).encode()

    files = {
        "README.md": filled(f"{node.kind}/README.md.in"),
        "package.xml": filled("package.xml.in"),
        "setup.cfg": filled(f"{node.kind}/setup.cfg.in"),
        "setup.py": filled("setup.py.in"),
        f"resource/{name}": b"",
        f"{name}/__init__.py": b"",
        f"{name}/{node.module}.py": node.code,
        f"launch/{name}.launch.py": filled("launch.py.in"),
        f"test/test_{node.module}.py": filled(f"{node.kind}/test.py.in"),
    }
    if node.main != node.module:
        files[f"{name}/{node.main}.py"] = filled(f"{node.kind}/{node.main}.py.in")
    return Package(files, node.module, "license and maintainer" if maintainer == NOBODY else "license")


def _project_for(name: str) -> Project:
    """Find the course's first project that has a controller of this name.

    Raises:
        TutorialError: none has.
    """
    known: set[str] = set()
    for path in sorted((HOME / "project").glob("step*.yaml"), key=lambda path: (len(path.stem), path.stem)):
        project = Project.load(path)
        names = {each.__name__ for item in project.bodies for each in item.controllers}
        if name in names:
            return project
        known |= names
    mend = "Yours takes the place of the one that has its name, so call the class like that."
    raise TutorialError(f"no step has a controller {name!r}.{did_you_mean(name, known)} {mend}")


def _needs(code: bytes) -> list[str]:
    """The ROS 2 packages that some code needs, and those that start it."""
    imported = set()
    for statement in ast.walk(ast.parse(code)):
        if isinstance(statement, ast.Import):
            imported |= {alias.name.partition(".")[0] for alias in statement.names}
        elif isinstance(statement, ast.ImportFrom):
            imported.add((statement.module or "").partition(".")[0])
    return sorted({"rclpy", "ros2launch"} | {module for module in imported if module.endswith(ROS_MODULES)})


def _nearest(name: str) -> str:
    """Make a valid name of another one, and ask whether it was meant; empty where little of it would be left."""
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)  # between the words of CamelCase
    near = re.sub(r"[^a-z0-9]+", "_", words.lower()).strip("_0123456789")
    return f" Did you mean {near!r}?" if VALID.fullmatch(near) else ""


def _ask_git(setting: str) -> str:
    try:
        return subprocess.run(["git", "config", setting], capture_output=True, text=True, check=False).stdout.strip()
    except OSError:  # there is no git
        return ""
