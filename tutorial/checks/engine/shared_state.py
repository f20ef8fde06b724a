"""Shared state: values that an answer stores on its class or in the notebook, where all its objects share them."""

import dis
import inspect
import io
import threading
from collections.abc import Iterator
from functools import partial
from types import CodeType, FunctionType
from typing import Any

import cloudpickle  # type: ignore[import-untyped, unused-ignore]
from rclpy.duration import Duration

from tutorial.checks.engine.answer import classes_of, functions_of

_LOCKS = {type(make()): lambda _, make=make: (make, ()) for make in (threading.Lock, threading.RLock)}
_DURATION = {Duration: lambda duration: (partial(Duration, nanoseconds=duration.nanoseconds), ())}
"""Durations from the real rclpy cannot be pickled, and every QoS profile contains durations."""

_NEW = object()
_DEFAULT = "the default value of the argument "


class SharedState:
    """Remember the state that an answer's objects share, to find changes later.

    Args:
        answer: the learner's class or function.
    """

    def __init__(self, answer: Any) -> None:
        self._answer = answer
        self._before = self._now()

    def changed(self) -> str:
        """Return the name of the first object that has changed, as the learner writes it; "" if nothing has changed."""
        return next((name for name, value in self._now().items() if self._before.get(name, _NEW) != value), "")

    def _now(self) -> dict[str, object]:
        return {name: _state(value) for name, value in outside(self._answer) if not _is_code(value)}


def cause_of_sharing(answer: Any, name: str) -> str:
    """Explain what is shared, and where it belongs instead.

    Args:
        answer: the learner's class or function.
        name: the shared object's name, as `SharedState.changed` returns it.
    """
    if not isinstance(answer, type) or name.startswith(_DEFAULT):
        return f"Your code keeps {name} from one call to the next. In each call, create everything that the call needs."
    return (
        f"{name} is shared by all objects of the class. Create a separate value for each object: "
        f"self.{name.rpartition('.')[2]} = ..., in __init__, configure or initialize."
    )


def outside(answer: Any) -> Iterator[tuple[str, Any]]:
    """Yield the names and values of everything that outlives an answer's objects or belongs to the notebook."""
    for kind in dict.fromkeys([*classes_of(answer), *_own_classes(answer)]):
        yield from _class_attributes(kind)
    for function in functions_of(answer):
        yield from _defaults(function)
        yield from inspect.getclosurevars(function).nonlocals.items()
        names = function.__globals__
        yield from ((name, names[name]) for name in _names(function.__code__) if name in names)


def _own_classes(answer: Any) -> Iterator[type]:
    """Yield the classes that the answer uses from its own module."""
    used = (function.__globals__.get(name) for function in functions_of(answer) for name in _names(function.__code__))
    return (each for each in used if isinstance(each, type) and each.__module__ == answer.__module__)


def _class_attributes(kind: type) -> Iterator[tuple[str, Any]]:
    kept = [*vars(kind).items()]  # a copy, because pickling an object adds an attribute to its class
    own = ((name, each) for name, each in kept if name[:2] != "__" and not isinstance(each, FunctionType))
    return ((f"{kind.__name__}.{name}", each) for name, each in own)


def _defaults(function: FunctionType) -> Iterator[tuple[str, Any]]:
    code, defaults = function.__code__, function.__defaults__ or ()
    arguments = code.co_varnames[code.co_argcount - len(defaults) : code.co_argcount]
    return ((_DEFAULT + name, each) for name, each in zip(arguments, defaults))


def _names(code: CodeType) -> list[str]:
    """Return the names of the globals (not the attributes) that a function and its nested functions use."""
    used = (each.argval for each in dis.get_instructions(code) if each.opname in ("LOAD_GLOBAL", "STORE_GLOBAL"))
    inner = (name for each in code.co_consts if isinstance(each, CodeType) for name in _names(each))
    return [*used, *inner]


def _is_code(value: Any) -> bool:
    return isinstance(value, type | property) or inspect.isroutine(value) or inspect.ismodule(value)


class _Pickler(cloudpickle.Pickler):  # type: ignore[misc, unused-ignore]
    dispatch_table = cloudpickle.Pickler.dispatch_table.new_child(_LOCKS | _DURATION)


def pickled(value: Any) -> bytes:
    """Pickle a value with everything that it refers to. A lock is unpickled as a new, unlocked lock."""
    with io.BytesIO() as file:
        _Pickler(file).dump(value)
        return file.getvalue()


def _state(value: Any) -> object:
    """Return a fingerprint that changes when the value changes."""
    try:
        return pickled(value)
    except Exception:  # noqa: BLE001 - pickling runs code of all kinds of objects
        return id(value)
