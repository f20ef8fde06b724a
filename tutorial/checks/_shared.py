"""What an answer keeps outside of its objects, on the class or in the notebook, and so shares between them."""

import inspect
import io
import threading
from collections.abc import Iterator
from types import CodeType, FunctionType
from typing import Any

import cloudpickle  # type: ignore[import-untyped, unused-ignore]

from tutorial.checks._watch import classes_of, functions_of

_LOCKS = {type(make()): lambda _, make=make: (make, ()) for make in (threading.Lock, threading.RLock)}
_NEW = object()
_DEFAULT = "the default of the argument "


class SharedState:
    """Remembers what an answer's class and globals hold, to tell later what has changed.

    Args:
        answer: the learner's class or function.
    """

    def __init__(self, answer: Any) -> None:
        self._answer = answer
        self._before = self._now()

    def changed(self) -> str:
        """Return the name of what has changed since, as the learner writes it; empty if nothing has."""
        return next((name for name, value in self._now().items() if self._before.get(name, _NEW) != value), "")

    def cause(self, otherwise: str) -> str:
        """Say what is shared and how to mend it, or something else where nothing is known to be."""
        name = self.changed()
        if not name:
            return otherwise
        if not isinstance(self._answer, type) or name.startswith(_DEFAULT):
            return f"Most likely {name} is kept from call to call: make what the call needs anew, within it."
        return (
            f"Most likely {name} is shared by all objects of the class: keep in each what is its own, "
            f"self.{name.rpartition('.')[2]} = ..., and make it in __init__, configure or initialize."
        )

    def _now(self) -> dict[str, object]:
        """Return what can be compared of what is outside of the answer's objects."""
        return {name: _state(value) for name, value in outside(self._answer) if not _is_code(value)}


def outside(answer: Any) -> Iterator[tuple[str, Any]]:
    """Yield what outlives an answer's objects, or belongs to the notebook, each with its name."""
    used = (function.__globals__.get(name) for function in functions_of(answer) for name in _names(function.__code__))
    own_kinds = (each for each in used if isinstance(each, type) and each.__module__ == answer.__module__)
    for kind in dict.fromkeys([*classes_of(answer), *own_kinds]):
        kept = [*vars(kind).items()]  # at once: to pickle an object adds an attribute to its class
        own = ((name, each) for name, each in kept if name[:2] != "__" and not isinstance(each, FunctionType))
        yield from ((f"{kind.__name__}.{name}", each) for name, each in own)
    for function in functions_of(answer):
        code, defaults = function.__code__, function.__defaults__ or ()
        arguments = code.co_varnames[code.co_argcount - len(defaults) : code.co_argcount]
        yield from ((_DEFAULT + name, each) for name, each in zip(arguments, defaults))
        yield from inspect.getclosurevars(function).nonlocals.items()
        names = function.__globals__
        yield from ((name, names[name]) for name in _names(code) if name in names)


def _names(code: CodeType) -> list[str]:
    """Collect the names in a function's code, and in that of the functions within."""
    inner = [name for each in code.co_consts if isinstance(each, CodeType) for name in _names(each)]
    return [*code.co_names, *inner]


def _is_code(value: Any) -> bool:
    return isinstance(value, type | property) or inspect.isroutine(value) or inspect.ismodule(value)


class _Pickler(cloudpickle.Pickler):  # type: ignore[misc, unused-ignore]
    dispatch_table = cloudpickle.Pickler.dispatch_table.new_child(_LOCKS)


def pickled(value: Any) -> bytes:
    """Pickle a value with all that it is made of. Locks are taken along: at the other end they are new, and free."""
    with io.BytesIO() as file:
        _Pickler(file).dump(value)
        return file.getvalue()


def _state(value: Any) -> object:
    """Return something that is equal as long as the value has not changed."""
    try:
        return pickled(value)
    except Exception:  # noqa: BLE001 - pickling runs code of all kinds of objects
        return id(value)
