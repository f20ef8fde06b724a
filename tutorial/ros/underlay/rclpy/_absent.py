"""What rclpy has and the embedded ROS 2 has not: whoever asks for it learns what needs a real ROS 2."""

import inspect
import json
import sys
from collections.abc import Callable
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from pathlib import Path
from pkgutil import resolve_name
from types import ModuleType
from typing import Any

from rclpy.exceptions import AbsentAttributeError, NeedsRealROSError

TABLE = json.loads(Path(__file__).with_name("absent.json").read_text(encoding="utf-8"))
"""By kind the names that rclpy's has and ours has not: modules, attributes of modules and classes, options."""


def install() -> None:
    """Have all that the table names refused from now on."""
    sys.meta_path.append(AbsentModules())
    for owner, names in TABLE["attributes"].items():
        resolve_name(owner).__getattr__ = absent(owner, names)


def absent(owner: str, names: list[str]) -> Callable[..., Any]:
    """Return a ``__getattr__`` for a module or class that refuses these names.

    Args:
        owner: what it is, such as ``"rclpy.executors"`` or ``"rclpy.node.Node"``.
        names: what rclpy's has and ours has not.
    """

    def refusing(*arguments: Any) -> Any:
        *instance, name = arguments
        if name in names:
            raise (AbsentAttributeError if instance else NeedsRealROSError)(f"{owner}.{name}")
        what = f"{type(instance[0]).__name__!r} object" if instance else f"module {owner!r}"
        raise AttributeError(f"{what} has no attribute {name!r}")

    return refusing


def refuse(function: str, options: dict[str, Any]) -> None:
    """Refuse options of a function that rclpy's has and ours has not, if they are used.

    Raises:
        NeedsRealROSError: one of them is.
        TypeError: rclpy's does not have it either.
    """
    for option, value in options.items():
        if option not in TABLE["options"][function]:
            raise TypeError(f"{function}() got an unexpected keyword argument {option!r}")
        if value:
            raise NeedsRealROSError(f"{function}({option}=...)")


def refuse_coroutine(callback: Any) -> None:
    """Refuse a callback that is a coroutine function.

    Raises:
        NeedsRealROSError: it is.
    """
    if inspect.iscoroutinefunction(callback):
        raise NeedsRealROSError("callbacks that are coroutines")


class AbsentModules(MetaPathFinder, Loader):
    """Finds the modules of rclpy that are not here, and refuses to load them."""

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:  # noqa: ARG002
        """Answer for these modules, and for nothing else."""
        package, _, name = fullname.partition(".")
        return ModuleSpec(fullname, self) if package == "rclpy" and name in TABLE["modules"] else None

    def exec_module(self, module: ModuleType) -> None:
        """Raise NeedsRealROSError."""
        raise NeedsRealROSError(module.__name__)
