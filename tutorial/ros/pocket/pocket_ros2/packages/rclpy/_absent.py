"""Reject any use of the parts of rclpy that the pocket ROS 2 lacks, and explain that they need a real ROS 2."""

import inspect
import json
import sys
from pathlib import Path
from pkgutil import resolve_name
from types import ModuleType
from typing import Any

from _absent import FROM_PYPI, AbsentAttributeError, AbsentModules, NeedsRealROSError, absent_names

TABLE = json.loads(Path(__file__).with_name("absent.json").read_text(encoding="utf-8"))
"""Names that only the real rclpy has, by kind: modules, attributes of modules and classes, options."""


def install() -> None:
    """Start rejecting uses of the names in the table."""
    sys.meta_path.append(AbsentModules([f"rclpy.{name}" for name in TABLE["modules"]]))
    for owner, names in TABLE["attributes"].items():
        place = resolve_name(owner)
        if isinstance(place, ModuleType):
            place.__getattr__ = absent_names(owner, names)  # type: ignore[method-assign]
        else:
            for name in names:
                setattr(place, name, AbsentAttribute(f"{owner}.{name}"))


class AbsentAttribute:
    """Placeholder in a class for an attribute that only the real rclpy has.

    A ``__getattr__`` in the class would also work, but it would slow down the lookup of all attributes.
    """

    def __init__(self, name: str) -> None:
        self._name = name

    def __get__(self, instance: object, owner: type) -> Any:
        raise AbsentAttributeError(self._name, FROM_PYPI)


def refuse(function: str, options: dict[str, Any]) -> None:
    """Reject function options that only the real rclpy supports.

    Raises:
        NeedsRealROSError: one of these options is used.
        TypeError: an option does not exist in the real rclpy either.
    """
    for option, value in options.items():
        if option not in TABLE["options"][function]:
            raise TypeError(f"{function}() got an unexpected keyword argument {option!r}")
        if value:
            raise NeedsRealROSError(f"{function}({option}=...)", FROM_PYPI)


def refuse_coroutine(callback: Any) -> None:
    """Reject a callback that is a coroutine function.

    Raises:
        NeedsRealROSError: the callback is a coroutine function.
    """
    if inspect.iscoroutinefunction(callback):
        raise NeedsRealROSError("callbacks that are coroutines", FROM_PYPI)
