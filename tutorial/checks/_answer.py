"""What was handed in: the right kind of thing or not, attempted or not."""

import dis
import inspect
from collections.abc import Iterable
from difflib import get_close_matches
from functools import partial
from types import EllipsisType
from typing import Any

from tutorial.checks._diagnose import NO_ARGUMENTS
from tutorial.checks._watch import Failure, Misuse
from tutorial.controller import SimpleController

_EMPTY = {
    *("RESUME", "NOP", "CACHE", "LOAD_CONST", "POP_TOP", "RETURN_VALUE", "RETURN_CONST", "PUSH_NULL"),
    *("PRECALL", "CALL", "RAISE_VARARGS", "COPY_FREE_VARS", "LOAD_GLOBAL"),
}
"""The instructions of a function that does nothing, or raises something."""


def misfit(answer: Any, name: str, base: type | None, call: str) -> str:
    """Say what to do if something else was given than a class, or a function.

    Args:
        answer: what was given.
        name: what the answer is called in the exercise.
        base: the class that it has to be made from, `object` for any; None where it is a function.
        call: how the check is called, for instance ``"drive.check"``.

    Returns:
        The mend as a sentence, empty when the kind is right.
    """
    mend = f"Give the {'function' if base is None else 'class'} itself: {call}({name})."
    if isinstance(answer, type) != (base is not None) or not callable(answer):
        return f"{getattr(answer, '__name__', f'An object of the class {type(answer).__name__}')} was given. {mend}"
    if base is not None and not issubclass(answer, base):
        return f"{answer.__name__} is not made from {base.__name__}. Begin it with: class {name}({base.__name__}):"
    return ""


def is_empty(function: Any) -> bool:
    """Whether a function's body is only a docstring, ``...``, ``pass`` or ``raise NotImplementedError``."""
    code = getattr(function, "__code__", None)
    if code is None or not {*code.co_names} <= {"NotImplementedError"}:
        return False
    has_text_only = all(isinstance(each, str | None | EllipsisType) for each in code.co_consts)
    return has_text_only and all(instruction.opname in _EMPTY for instruction in dis.get_instructions(code))


def unwritten(answer: Any, parts: Iterable[str]) -> bool:
    """Whether nothing of an answer is written yet.

    Args:
        answer: the class or function.
        parts: the methods that are to be written.
    """
    if not isinstance(answer, type):
        return is_empty(answer if hasattr(answer, "__code__") else type(answer).__call__)
    own = [name for name in vars(answer) if not name.startswith("__")]
    found = (inspect.getattr_static(answer, name) for name in (*parts, *own) if has(answer, name))
    functions = (getattr(each, "__func__", each) for each in found)
    return all(is_empty(each) for each in functions if inspect.isfunction(each))


def name_of(answer: Any) -> str:
    """Return what a callable is called: a function's name, that of a partial's, or that of an object's class."""
    inner = answer.func if isinstance(answer, partial) else answer
    return str(getattr(inner, "__name__", type(inner).__name__))


def has(answer: type, name: str) -> bool:
    """Whether a class has a method of its own, or from a class that is not the common base."""
    return any(name in vars(each) for each in answer.__mro__ if each is not SimpleController)


def check_has(answer: type, *methods: str) -> None:
    """Look whether methods of a learner's class are there that have to be written.

    Raises:
        Failure: one is missing, or empty.
    """
    for method in methods:
        if not has(answer, method):
            raise Failure(method, Misuse(f"{answer.__name__} has no such method", _mend(answer, method)))
        if is_empty(inspect.getattr_static(answer, method)):
            raise Failure(method, Misuse("it is still empty", f"Write the method {method}."))


def _mend(answer: type, part: str) -> str:
    others = [name for name in vars(answer) if not (name.startswith("__") or hasattr(SimpleController, name))]
    near = get_close_matches(part, others, n=1)
    if near:
        return f"Most likely its name is misspelled: {near[0]} should be {part}."
    made = getattr(vars(answer).get("__init__"), "__code__", None)
    if made is not None and made.co_argcount > 1 and issubclass(answer, SimpleController):
        return f"Most likely __init__ does its work. {NO_ARGUMENTS}"
    more = " What is simulated is io.body." * (part == "initialize")
    return f"Write the method {part}; it is part of the answer.{more}"
