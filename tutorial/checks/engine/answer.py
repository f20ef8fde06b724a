"""Inspect an answer: whether it is the required kind of object, whether it has any code yet, and what it contains."""

import dis
import inspect
from collections.abc import Iterable
from difflib import get_close_matches
from functools import partial
from types import EllipsisType, FunctionType
from typing import Any

from tutorial.checks.engine.exceptions import NO_ARGUMENTS
from tutorial.checks.engine.failure import Failure, Misuse
from tutorial.controller import SimpleController

_EMPTY = {
    *("RESUME", "NOP", "CACHE", "LOAD_CONST", "POP_TOP", "RETURN_VALUE", "RETURN_CONST", "PUSH_NULL"),
    *("PRECALL", "CALL", "RAISE_VARARGS", "COPY_FREE_VARS", "LOAD_GLOBAL"),
}
"""The instructions that a function can contain if it does nothing or only raises an exception."""

_HELP = {
    "initialize": " In initialize, io.body is the simulated body. In configure, config.body is the displayed body.",
}
"""Facts that learners need to write a method, keyed by the method's name."""

_OURS = ("builtins", "tutorial.controller")
_ENGINE = "tutorial.checks.engine."  # functions from these modules can be part of an answer's class


def misfit(answer: Any, name: str, base: type | None, call: str) -> str:
    """Return an error message if an answer is not the kind of class or function that the exercise needs, otherwise "".

    Args:
        answer: the learner's object.
        name: the name that the answer has in the exercise.
        base: the class that the answer has to inherit from; `object` if any class will do; None for a function.
        call: the call that starts the check, for instance ``"await drive.check"``.
    """
    instead = f"Pass the {'function' if base is None else 'class'} itself: {call}({name})."
    if isinstance(answer, type) != (base is not None) or not callable(answer):
        return f"{getattr(answer, '__name__', f'An object of the class {type(answer).__name__}')} was passed. {instead}"
    if base is not None and not issubclass(answer, base):
        return f"{answer.__name__} does not inherit from {base.__name__}. Define it as: class {name}({base.__name__}):"
    return ""


def is_empty(function: Any) -> bool:
    """Return whether a function's body is only a docstring, ``...``, ``pass`` or ``raise NotImplementedError``."""
    code = getattr(function, "__code__", None)
    if code is None or not {*code.co_names} <= {"NotImplementedError"}:
        return False
    has_text_only = all(isinstance(each, str | None | EllipsisType) for each in code.co_consts)
    return has_text_only and all(instruction.opname in _EMPTY for instruction in dis.get_instructions(code))


def unwritten(answer: Any, parts: Iterable[str]) -> bool:
    """Return whether an answer has no code yet.

    Args:
        answer: the class or function.
        parts: the methods that the learner has to write.
    """
    if not isinstance(answer, type):
        return is_empty(answer if hasattr(answer, "__code__") else type(answer).__call__)
    own = [name for name in vars(answer) if not name.startswith("__")]
    found = (inspect.getattr_static(answer, name) for name in (*parts, *own) if has(answer, name))
    functions = (getattr(each, "__func__", each) for each in found)
    return all(is_empty(each) for each in functions if inspect.isfunction(each))


def name_of(answer: Any) -> str:
    """Return the name of a function, of the function in a `partial`, or of a callable object's class."""
    inner = answer.func if isinstance(answer, partial) else answer
    return str(getattr(inner, "__name__", type(inner).__name__))


def has(answer: type, name: str) -> bool:
    """Return whether a class defines a method, or inherits it from a class other than the common base."""
    return any(name in vars(each) for each in answer.__mro__ if each is not SimpleController)


def check_has(answer: type, *methods: str) -> None:
    """Check that a learner's class has the required methods.

    Raises:
        Failure: a method is missing or empty.
    """
    for method in methods:
        if not has(answer, method):
            raise Failure(method, Misuse(f"{answer.__name__} has no such method", _what_to_write(answer, method)))
        if is_empty(inspect.getattr_static(answer, method)):
            raise Failure(method, Misuse("it is still empty", f"Write the method {method}.{_HELP.get(method, '')}"))


def classes_of(answer: Any) -> list[type]:
    """Return an answer's class and its base classes, except for those of Python and of the tutorial."""
    kind = answer if isinstance(answer, type) else type(answer)
    return [each for each in kind.__mro__ if each.__module__ not in _OURS]


def functions_of(answer: Any) -> list[FunctionType]:
    """Return an answer's functions, such as the methods of a class."""
    members = (member for each in classes_of(answer) for member in vars(each).values())
    found = (getattr(each, "__func__", each) for each in (answer, *members))
    return [each for each in found if isinstance(each, FunctionType) and _ENGINE not in str(each.__module__)]


def files_of(answer: Any) -> set[str]:
    """Return the files or notebook cells that contain an answer's functions."""
    return {function.__code__.co_filename for function in functions_of(answer)}


def _what_to_write(answer: type, part: str) -> str:
    others = [name for name in vars(answer) if not (name.startswith("__") or hasattr(SimpleController, name))]
    near = get_close_matches(part, others, n=1)
    if near:
        return f"You probably misspelled its name: {near[0]} should be {part}."
    made = getattr(vars(answer).get("__init__"), "__code__", None)
    if made is not None and made.co_argcount > 1 and issubclass(answer, SimpleController):
        return f"You probably put its code into __init__. {NO_ARGUMENTS}"
    return f"Write the method {part}; it is part of the answer.{_HELP.get(part, '')}"
