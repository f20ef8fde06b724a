"""Exceptions in the learner's code: their most likely causes, by their types and by CPython's messages.

CPython may change its messages. An exception whose message has no entry here is shown without a specific cause.
"""

import dis
import inspect
import re
from difflib import get_close_matches
from traceback import walk_tb
from typing import Any

from tutorial.controller import SimpleController

AT_ONCE = "Most likely the callback is called at once: give it without parentheses, self.{}."
NO_ARGUMENTS = "__init__ is given nothing: config comes to configure(self, config), and io to initialize(self, io)."
_STEPS = "{} is called once for every step and returns at once; the loop is the simulation's. To wait, count steps."
_RETURNS = {
    "control": _STEPS,
    "aim": _STEPS,
    "unconfigure": "to wait for a thread's end, join it; that its queue is empty is not its end.",
    "update": "{} runs on the main thread, and nothing else is drawn or answered meanwhile: draw, and return.",
    "callback": "{} is a callback: it puts the message away, or posts a call, and returns; it never waits or repeats.",
}
"""Why a method has to return at once, by its name."""
_PROGRAMS = "Leave it out: the program has called rclpy.init, spins its node, config.node, and shuts rclpy down."
_CALLED_ONCE = {"init", "create_node", "spin", "spin_once", "spin_until_future_complete", "shutdown"}
_CONFIG = ("body", "node", "call_later", "call_latest")
_KEEP = {
    "io": "initialize does not keep it: self.io = io.",
    **{each: f"configure does not keep it: self.{each} = config.{each}." for each in _CONFIG},
}
_UNSET = "it is read before anything has set it: "
_LIFE = "configure comes first, then initialize, then control; a message may come as soon as there is a subscription."
_CLASS = "Most likely parentheses are missing: {0} alone is the class, {0}(...) makes an object of it."
_GENERAL = "Mend this line first; what comes after it has not been looked at."
_CAUSES = {
    r"RuntimeError: .*event loop": "Most likely it asks for the event loop, or calls it, on another thread than the "
    "main one: a callback posts, self.call_later(self.update, message), and what is posted may ask for the loop.",
    r"AttributeError: 'tuple'": "A tuple is in its place: take it apart, as in positions, report = match_joints(...).",
    r"AttributeError: type object '(\w+)'": _CLASS,
    r"AttributeError: .* has no attribute '(?:nano)?sec'": "Most likely the stamp is a number, or a Time that is no "
    "message: Time(nanoseconds=self.io.time_ns).to_msg() makes one.",
    r"TypeError: unhashable type: '(\w+)'": "A {0} cannot be the key of a dict: take a tuple of numbers, or a name.",
    r"TypeError: (?:\w+\.)*(\w+)\.\w+\(\) missing 1 required positional argument: 'self'": _CLASS,
    r"TypeError: \S*__init__\(\) missing": NO_ARGUMENTS,
    r"TypeError: (?:\S+\.)?(on_\w+)\(\) missing 1 required positional argument": AT_ONCE,
}


def likely_cause(error: BaseException, answer: Any) -> str:
    """Return the most likely cause of an exception, as a sentence.

    Args:
        error: the exception.
        answer: the learner's class or function.
    """
    frames = [frame for frame, _ in walk_tb(error.__traceback__)]
    called = {each.f_code.co_name for each in frames if str(each.f_globals.get("__name__")).startswith("rclpy")}
    causes = [_PROGRAMS] if called & _CALLED_ONCE else []
    owner, name = (error.obj, str(error.name)) if isinstance(error, AttributeError) else (None, "")
    if isinstance(answer, type) and isinstance(owner, answer):
        causes.append(_unset(answer, name))
    text = f"{type(error).__name__}: {error}"
    taken = re.match(r"TypeError: (?:\S+\.)?(\w+)\(\) takes", text)
    method = getattr(answer, taken[1], None) if taken else None
    if inspect.isfunction(method):
        causes.append(_no_self(method))
    causes += [cause.format(*found.groups()) for each, cause in _CAUSES.items() if (found := re.match(each, text))]
    if owner is not None:
        causes.append(_what_there_is(owner, name))
    return next(filter(None, causes), _GENERAL)


def slept(method: str) -> str:
    """Say what to change in a method that sleeps."""
    return f"Leave out what sleeps or waits: {_returns(method) or 'nothing else goes on until it returns.'}"


def endless(method: str) -> str:
    """Say why a method probably does not return."""
    return _returns(method) or "Most likely the condition of a loop never becomes false, or it waits for something."


def _returns(method: str) -> str:
    kind = "callback" if method.startswith("on_") or "back" in method else method
    return _RETURNS.get(kind, "").format(method)


def _no_self(function: Any) -> str:
    """Say how to begin a method whose ``self`` is missing; return an empty text for any other method."""
    code = function.__code__
    arguments = code.co_varnames[: code.co_argcount]
    if code.co_flags & inspect.CO_VARARGS or arguments[:1] == ("self",):
        return ""
    return f"Most likely self is missing: def {code.co_name}({', '.join(('self', *arguments))}):"


def _unset(answer: type, name: str) -> str:
    """Say why the learner's object probably lacks an attribute."""
    codes = {each: value.__code__ for each, value in vars(answer).items() if inspect.isfunction(value)}
    for method, code in codes.items():
        if name in code.co_varnames[code.co_argcount :]:
            return f"Most likely self is missing in {method}: self.{name} = ..."
    life = _LIFE if issubclass(answer, SimpleController) else "let __init__ set it."
    steps = [step for code in codes.values() for step in dis.get_instructions(code)]
    is_set = any(step.opname == "STORE_ATTR" and step.argval == name for step in steps)
    return f"Most likely {_UNSET + life if is_set else _KEEP.get(name, _UNSET + life)}"


def _what_there_is(owner: Any, name: str) -> str:
    there = [each for each in dir(owner) if each[0] != "_" and each.islower()]
    return next((f"Did you mean {each!r}?" for each in get_close_matches(name, there, n=1)), _GENERAL)
