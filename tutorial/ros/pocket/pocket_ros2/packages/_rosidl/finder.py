"""An import finder for all message packages, such as ``std_msgs.msg`` and ``sensor_msgs.msg``.

As in a real installation, ``sensor_msgs.msg.Joy`` is defined in ``sensor_msgs.msg._joy``. The finder creates each
class on first use.
"""

import re
import sys
from collections.abc import Iterable
from difflib import get_close_matches
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

PACKAGE_SUFFIXES = ("_msgs", "_interfaces", "_common")
"""Suffixes of the names of message packages. They are checked first, so that importing any other package does
not load the definitions."""


def install() -> None:
    """Install the finder before other finders, because this rclpy can send only the finder's messages. Idempotent."""
    if not any(isinstance(finder, InterfaceFinder) for finder in sys.meta_path):
        sys.meta_path.insert(0, InterfaceFinder())


class InterfaceFinder(MetaPathFinder, Loader):
    """Finds and loads ``PACKAGE``, ``PACKAGE.msg`` and ``PACKAGE.msg._some_message``."""

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:  # noqa: ARG002
        """Return a spec for a message package or a module in a message package; None for anything else.

        Raises:
            ImportError: there is no such message, but there is a message with a similar name.
        """
        package, *rest = fullname.split(".")
        names = _message_names(package) if package.endswith(PACKAGE_SUFFIXES) else {}
        if not names or rest[:1] not in ([], ["msg"]) or len(rest) > 2:
            return None
        if len(rest) == 2 and rest[1] not in names:
            _suggest(rest[1], package, names.values())
            return None
        return ModuleSpec(fullname, self, is_package=len(rest) < 2)

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Create the module; a ``msg`` module creates its message classes on demand."""
        return MessagesModule(spec.name) if spec.name.endswith(".msg") else None

    def exec_module(self, module: ModuleType) -> None:
        """If the module is for a single message, add the message's class to the module."""
        package, *rest = module.__name__.split(".")
        if len(rest) == 2:
            from _rosidl.message import make_message_class  # noqa: PLC0415  (`import tutorial` needs no numpy)

            name = _message_names(package)[rest[1]]
            setattr(module, name, make_message_class(f"{package}/msg/{name}", module.__name__))


class MessagesModule(ModuleType):
    """``PACKAGE.msg``, which has all messages of the package as attributes."""

    def __init__(self, name: str) -> None:
        super().__init__(name, f"Messages of {name.partition('.')[0]}, as ROS 2 Jazzy defines them.")
        self.__all__ = sorted(_message_names(name.partition(".")[0]).values())

    def __getattr__(self, name: str) -> Any:
        if name not in self.__dict__.get("__all__", ()):
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        found = getattr(import_module(f"{self.__name__}.{_module_name(name)}"), name)
        setattr(self, name, found)  # from now on, Python finds the class directly
        return found

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.__all__]


def _suggest(name: str, package: str, known: Iterable[str]) -> None:
    """Raise an error that suggests a message with a similar name. If there is none, let Python raise its own error."""
    near = get_close_matches(name, known, n=1)
    if near and near[0] != name and not name.startswith("_"):
        path = f"{package}.msg"
        raise ImportError(f"cannot import name {name!r} from {path!r}. Did you mean {near[0]!r}?", name=path)


def _message_names(package: str) -> dict[str, str]:
    """Return the names of the package's messages, keyed by module name: ``{"_joint_state": "JointState", ...}``."""
    from _rosidl.definitions import type_names  # noqa: PLC0415  (as above)

    return {_module_name(name): name for name in type_names().get(package, ())}


def _module_name(name: str) -> str:
    """Convert a message name to its module name, as rosidl does: ``JointState`` to ``_joint_state``."""
    name = re.sub("(.)([A-Z][a-z]+)", r"\1_\2", name)
    return "_" + re.sub("([a-z0-9])([A-Z])", r"\1_\2", name).lower()
