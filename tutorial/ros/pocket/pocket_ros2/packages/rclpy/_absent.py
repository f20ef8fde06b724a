"""What rclpy has and the pocket ROS 2 has not: whoever asks for it learns what needs a real ROS 2."""

import inspect
import json
import sys
from pathlib import Path
from pkgutil import resolve_name
from types import ModuleType
from typing import Any

from _absent import FROM_PYPI, AbsentAttributeError, AbsentModules, NeedsRealROSError, absent_names

TABLE = json.loads(Path(__file__).with_name("absent.json").read_text(encoding="utf-8"))
"""By kind the names that rclpy's has and ours has not: modules, attributes of modules and classes, options."""


def install() -> None:
    """Have all that the table names refused from now on."""
    sys.meta_path.append(AbsentModules([f"rclpy.{name}" for name in TABLE["modules"]]))
    for owner, names in TABLE["attributes"].items():
        place = resolve_name(owner)
        if isinstance(place, ModuleType):
            place.__getattr__ = absent_names(owner, names)  # type: ignore[method-assign]
        else:
            for name in names:
                setattr(place, name, AbsentAttribute(f"{owner}.{name}"))


class AbsentAttribute:
    """Stands in a class for what rclpy's has and ours has not.

    A ``__getattr__`` of the class would do, too, but with one Python looks up whatever objects have the slow way.
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, instance: object, owner: type) -> Any:
        raise AbsentAttributeError(self._name, FROM_PYPI)


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
            raise NeedsRealROSError(f"{function}({option}=...)", FROM_PYPI)


def refuse_coroutine(callback: Any) -> None:
    """Refuse a callback that is a coroutine function.

    Raises:
        NeedsRealROSError: it is.
    """
    if inspect.iscoroutinefunction(callback):
        raise NeedsRealROSError("callbacks that are coroutines", FROM_PYPI)
