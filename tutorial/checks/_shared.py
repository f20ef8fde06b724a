"""What an answer keeps outside of its objects, on the class or in the notebook, and so shares between them."""

from __future__ import annotations

import inspect
from collections import deque
from collections.abc import Iterator, Mapping
from typing import Any

from tutorial.checks._watch import watch
from tutorial.handoff import Latest

__all__ = ["SharedState"]

DEEP = 4  # levels of containers and objects that are looked into

_PLAIN = (bool, int, float, complex, str, bytes, type(None))


class SharedState:
    """Remembers what an answer's class and globals hold, to tell later what has changed.

    Args:
        answer: the learner's class or function.
    """

    def __init__(self, answer: Any) -> None:
        self._answer = answer
        self._before = dict(_values(answer))

    def changed(self) -> str:
        """Return the name of what has changed since, as the learner writes it; empty if nothing has."""
        after = dict(_values(self._answer))
        return next((name for name, value in after.items() if self._before.get(name, _NEW) != value), "")

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


_NEW = object()
_DEFAULT = "the default of the argument "


def _values(answer: Any) -> Iterator[tuple[str, object]]:
    """Yield the names of what outlives the answer's objects, each with what can be compared of it."""
    classes = [each for each in getattr(answer, "__mro__", ()) if _is_learners(each)]
    for each in classes:
        for name, value in vars(each).items():
            if not name.startswith("__") and not inspect.isroutine(value) and not isinstance(value, property):
                yield f"{each.__name__}.{name}", _comparable(value)
    members = [member for each in classes for member in vars(each).values()]
    for function in filter(inspect.isfunction, (answer, *members)):
        if function.__code__.co_filename not in watch.files:
            continue
        code, defaults = function.__code__, function.__defaults__ or ()
        for value, name in zip(defaults, code.co_varnames[code.co_argcount - len(defaults) : code.co_argcount]):
            yield _DEFAULT + name, _comparable(value)
        for name in function.__code__.co_names:
            value = function.__globals__.get(name)
            if not isinstance(value, type) and not inspect.isroutine(value) and not inspect.ismodule(value):
                yield name, _comparable(value)


def _is_learners(kind: type) -> bool:
    codes = (getattr(member, "__code__", None) for member in vars(kind).values())
    return any(code is not None and code.co_filename in watch.files for code in codes)


def _comparable(value: Any, depth: int = DEEP) -> object:
    """Return something that is equal as long as the value has not changed."""
    if isinstance(value, _PLAIN):
        return repr(value)  # two NaNs are not equal
    if depth == 0:
        return id(value)
    if isinstance(value, Latest):
        return _comparable(value.get(), depth - 1)
    if isinstance(value, Mapping):
        return [(repr(key), _comparable(each, depth - 1)) for key, each in list(value.items())]
    if isinstance(value, (list, tuple, deque)):
        return [_comparable(each, depth - 1) for each in list(value)]
    inside = getattr(value, "__dict__", {})
    return (id(value), [(name, _comparable(each, depth - 1)) for name, each in list(inside.items())])
