"""Exceptions in the learner's code: their most likely causes, by type and by CPython's message.

CPython's messages can change with each version. An exception whose message has no entry here is reported without a
specific cause.
"""

import dis
import inspect
import re
from difflib import get_close_matches
from traceback import walk_tb
from typing import Any

from rclpy.exceptions import NotInitializedException

from tutorial.controller import SimpleController

AT_ONCE = "Your code probably calls the callback immediately. Pass it without parentheses: self.{}."
NO_ARGUMENTS = "__init__ gets no arguments: configure(self, config) gets config, and initialize(self, io) gets io."
_STEPS = "The simulation calls {} once per step, so it needs no loop: return immediately. To wait, count steps."
_RETURNS = {
    "control": _STEPS,
    "aim": _STEPS,
    "unconfigure": "To wait until a thread has ended, join it. An empty queue does not mean that the thread has ended.",
    "update": "{} runs on the main thread, which can do nothing else in the meantime: draw, and return.",
    "callback": "{} is a callback: store the message or post a call, and return. Never wait or loop in a callback.",
}
"""Why a method must return at once, keyed by the method's name."""
_PROGRAMS = "Remove this call: the program calls rclpy.init, spins {}, and shuts rclpy down."
_CALLED_ONCE = {"init", "create_node", "spin", "spin_once", "spin_until_future_complete", "shutdown"}
_CONFIG = ("body", "node", "call_later", "call_latest")
_KEEP = {
    "io": "Your code probably doesn't store it in initialize: self.io = io.",
    **{each: f"Your code probably doesn't store it in configure: self.{each} = config.{each}." for each in _CONFIG},
}
_UNSET = "Your code probably reads it before it is set: "
_LIFE = "configure runs first, then initialize, then control; a message can arrive as soon as the subscription exists."
_CLASS = "You probably forgot the parentheses: {0} is the class, and {0}(...) creates an object."
_GENERAL = "Fix this line first. The check stopped here."
_RAISES = "Your code raises this error itself, and nothing catches it. Catch it, or report the problem in a result."
_CAUSES = {
    r"RuntimeError: .*event loop": "Your code probably uses the event loop outside the main thread. Post a call, "
    "self.call_later(self.update, message): the posted call can use the loop.",
    r"AttributeError: 'tuple'": "The value is a tuple. Unpack it, as in positions, report = match_joints(...).",
    r"AttributeError: type object '(\w+)'": _CLASS,
    r"AttributeError: .* has no attribute '(?:nano)?sec'": "The stamp is probably a number, or a Time that "
    "is not a message. Convert it to a message: Time(nanoseconds=self.io.time_ns).to_msg().",
    r"ParameterNotDeclaredException": "No parameter with this name has been declared yet. Each declaration also calls "
    "the callbacks, so add your callback after all declarations.",
    r"RecursionError": "This line calls its own method, directly or through a callback, and the recursion never ends.",
    r"TypeError: 'FloatingPointRange' object": "The range is a list: floating_point_range=[FloatingPointRange(...)].",
    r"TypeError: .*must be callable": "Your code probably calls the function immediately. Pass it without parentheses, "
    "as in self.ask(self.read).",
    r"TypeError: CallbackGroup\.\w+\(\) missing": "You probably forgot the parentheses: "
    "MutuallyExclusiveCallbackGroup() creates a group.",
    r"TypeError: unsupported format string passed to NoneType": "The number is None: the function that computes it "
    "probably lacks return.",
    r"TypeError: unhashable type: '(\w+)'": "A {0} cannot be a key in a dict. Use a tuple of numbers, or a name.",
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
    is_own = called & _CALLED_ONCE or isinstance(error, NotInitializedException)
    causes = [_programs(answer)] if is_own else []
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
    if _is_raised_by(error, answer):
        causes.append(_RAISES)
    return next(filter(None, causes), _GENERAL)


def _is_raised_by(error: BaseException, answer: Any) -> bool:
    """Return whether an exception was raised by one of the learner's own ``raise`` statements."""
    last = error.__traceback__
    while last is not None and last.tb_next is not None:
        last = last.tb_next
    if last is None or last.tb_frame.f_globals.get("__name__") != getattr(answer, "__module__", None):
        return False
    return dis.opname[last.tb_frame.f_code.co_code[last.tb_lasti]] == "RAISE_VARARGS"


def _programs(answer: Any) -> str:
    """Return the advice for an answer that initializes, spins or shuts down rclpy itself."""
    if isinstance(answer, type) and not issubclass(answer, SimpleController):
        return _PROGRAMS.format(f"the node that {answer.__name__} gets")
    return _PROGRAMS.format("its node (config.node)")


def slept(method: str) -> str:
    """Return the advice for a method that sleeps."""
    return f"Don't sleep or wait. {_returns(method) or 'Nothing else runs until the method returns.'}"


def endless(method: str) -> str:
    """Return the most likely reason why a method does not return."""
    return (
        _returns(method) or "The condition of a loop probably never becomes false, or the method waits for something."
    )


def _returns(method: str) -> str:
    kind = "callback" if method.startswith("on_") or "back" in method else method
    return _RETURNS.get(kind, "").format(method)


def _no_self(function: Any) -> str:
    """Return the advice for a method that lacks ``self``, or an empty string for any other method."""
    code = function.__code__
    arguments = code.co_varnames[: code.co_argcount]
    if code.co_flags & inspect.CO_VARARGS or arguments[:1] == ("self",):
        return ""
    return f"You probably forgot self: def {code.co_name}({', '.join(('self', *arguments))}):"


def _unset(answer: type, name: str) -> str:
    """Return the most likely reason why the learner's object lacks an attribute."""
    codes = {each: value.__code__ for each, value in vars(answer).items() if inspect.isfunction(value)}
    for method, code in codes.items():
        if name in code.co_varnames[code.co_argcount :]:
            return f"You probably forgot self in {method}: self.{name} = ..."
    life = _LIFE if issubclass(answer, SimpleController) else "set it in __init__."
    steps = [step for code in codes.values() for step in dis.get_instructions(code)]
    is_set = any(step.opname == "STORE_ATTR" and step.argval == name for step in steps)
    return _UNSET + life if is_set else _KEEP.get(name, _UNSET + life)


def _what_there_is(owner: Any, name: str) -> str:
    there = [each for each in dir(owner) if each[0] != "_" and each.islower()]
    return next((f"Did you mean {each!r}?" for each in get_close_matches(name, there, n=1)), _GENERAL)
