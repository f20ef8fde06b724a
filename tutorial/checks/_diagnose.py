"""What most likely led to an exception in the learner's code.

Some of it only CPython's own sentences tell. They are no interface: what is looked for here has been found in those of
the versions in `PROVED`. On any other, and where a sentence is another, an exception speaks for itself.
"""

from __future__ import annotations

import dis
import inspect
import re
import sys
from collections.abc import Iterator
from difflib import get_close_matches
from traceback import walk_tb
from types import FrameType, FunctionType, MemberDescriptorType, MethodType
from typing import Any

from tutorial.controller import SimpleController
from tutorial.errors import WrongThreadError
from tutorial.joints import JointReport

__all__ = [
    "AT_ONCE",
    "Misuse",
    "blamed",
    "lacks_self",
    "likely_cause",
    "no_self",
    "owner_of",
    "sentence",
    "sets",
    "slept",
]

PROVED = ((3, 11), (3, 12), (3, 13))
"""The versions of CPython whose sentences are known."""

AT_ONCE = "Most likely the callback is called at once: give it without parentheses, self.{name}."
_SLEPT = "time passes by itself; who has called it waits with it, and all that comes after."
_SLEPT_BY = {
    "control": "control is called once for every step, and the simulation waits with it: count steps, io.step.",
    "aim": "aim is called once for every step, and the simulation waits with it: simulated time goes on by itself.",
    "update": "it runs on the main thread, and nothing else is drawn or answered meanwhile: draw, and return.",
}
_SLEPT_BACK = (
    "it is a callback, and the executor's thread waits with it: put the message away, or post a call, and return."
)
NO_ARGUMENTS = "__init__ is given nothing: config comes to configure(self, config), and io to initialize(self, io)."
_GENERAL = "Mend this line first; what comes after it has not been looked at."
_UNSET = "Most likely it is read before anything has set it: "
_KEEP = {
    "io": ("initialize", "self.io = io"),
    **{name: ("configure", f"self.{name} = config.{name}") for name in ("body", "node", "call_later", "call_latest")},
}
_LIFE = "configure comes first, then initialize, then control; a message may come at any time after configure."
_NONE = "Most likely what stands before the dot is None: nothing was kept or returned there."
_CLASS = "Most likely parentheses are missing: {name} alone is the class, {name}(...) makes an object of it."
_LOOP = (
    "Most likely it asks for the event loop, or calls it, on another thread than the main one, as in a callback: that "
    "posts, self.call_later(self.update, message), and what is posted may ask for the loop."
)
_SPIN = "Leave it out: the program spins its node already, on a thread of its own, and spin never returns."
_PROGRAMS = {
    "spin": _SPIN,
    "spin_once": _SPIN,
    "spin_until_future_complete": _SPIN,
    "init": "Leave it out: the program has called rclpy.init already; a controller uses config.node.",
    "shutdown": "Leave it out: rclpy belongs to the whole program, which shuts it down at its end.",
    "create_node": "Leave it out: the program has a node already, config.node.",
}
_CAUSES = {
    NameError: "Most likely its import or definition is missing: write it into the same cell as the class.",
    ImportError: "Most likely the name is spelled differently, or the module is not installed.",
    SystemExit: "Most likely an exit() was left over; a controller only returns.",
    WrongThreadError: "The displayed body belongs to the main thread: post the call instead, self.call_later(...).",
    KeyboardInterrupt: "A controller only returns; to interrupt is the user's business.",
}
_TYPES = {
    "'property' object": "Most likely parentheses are missing where an object is made: a class was used in its place.",
    "unhashable": "Most likely a list is taken for a key: take what says what it is about, such as the body's name.",
}
_ATTRIBUTE = re.compile(r"'(\w+)' object has no attribute '(\w+)'")
_GIVEN = re.compile(r"(\S+)\(\) takes .*positional arguments? but (\d+) (?:was|were) given")
_LACKING = re.compile(r"(\S+)\(\) missing \d+ required positional arguments?: (.*)")


class Misuse(Exception):  # noqa: N818 - not an error of this library, but of the learner's code
    """Something was called in a way that cannot work, and it is known why.

    Args:
        text: what was done.
        cause: the most likely cause, as a sentence.
    """

    def __init__(self, text: str, cause: str) -> None:
        super().__init__(text)
        self.cause = cause


def sentence(error: BaseException) -> str:
    """Return CPython's sentence about an exception; empty where it is not known what its sentences look like."""
    is_known = sys.implementation.name == "cpython" and sys.version_info[:2] in PROVED
    return str(error) if is_known else ""


def likely_cause(error: BaseException, answer: Any) -> str:
    """Name the most likely cause of an exception.

    Args:
        error: what was raised.
        answer: the learner's class or function.
    """
    if isinstance(error, Misuse):
        return error.cause
    ros = _of_rclpy(error)
    if ros:
        return ros
    if isinstance(error, RuntimeError) and "event loop" in sentence(error):
        return _LOOP
    if isinstance(error, AttributeError):
        return _attribute(error, answer)
    if isinstance(error, TypeError):
        return _call(error, answer)
    return next((cause for kind, cause in _CAUSES.items() if isinstance(error, kind)), _GENERAL)


def slept(method: str) -> str:
    """Say what is wrong about a method that sleeps."""
    is_callback = method.startswith("on_") or "back" in method
    reason = _SLEPT_BY.get(method, _SLEPT_BACK if is_callback else _SLEPT)
    return f"Leave out what sleeps or waits: {reason}"


def lacks_self(function: Any, given: int) -> bool:
    """Whether a method takes too few arguments because ``self`` is not among them.

    Args:
        function: the method, as a function.
        given: how many arguments it gets, the object included.
    """
    code = function.__code__
    takes_any = code.co_flags & inspect.CO_VARARGS
    return not takes_any and code.co_argcount < given and code.co_varnames[: min(1, code.co_argcount)] != ("self",)


def no_self(function: Any) -> str:
    """Say how a method begins that has forgotten ``self``."""
    code = function.__code__
    arguments = ", ".join(("self", *code.co_varnames[: code.co_argcount]))
    return f"Most likely self is missing: def {code.co_name}({arguments}):"


def blamed(error: BaseException, answer: Any) -> FunctionType | None:
    """Find the learner's method that was called with too many arguments, because it has forgotten ``self``."""
    found = _GIVEN.search(sentence(error)) if isinstance(error, TypeError) else None
    function = _method(answer, found[1]) if found else None
    return function if found and function and lacks_self(function, int(found[2])) else None


def owner_of(error: AttributeError) -> tuple[Any, str]:
    """Find out whose attribute was looked for, and its name; Python does not always tell.

    Returns:
        The object, None where it is None or cannot be found, and the name.
    """
    if error.name is not None:
        return error.obj, error.name
    found = _ATTRIBUTE.search(sentence(error))
    if found is None:
        return None, ""
    near = (value for value in _in_reach(error) if type(value).__name__ == found[1])
    return next(near, None), found[2]


def sets(function: Any, name: str) -> bool:
    """Whether a function sets an attribute of that name."""
    code = getattr(function, "__code__", None)
    return code is not None and any(i.opname == "STORE_ATTR" and i.argval == name for i in dis.get_instructions(code))


def _attribute(error: AttributeError, answer: Any) -> str:
    owner, name = owner_of(error)
    if isinstance(answer, type) and isinstance(owner, answer):
        return _unset(answer, name)
    if owner is None:
        return _NONE if "'NoneType' object" in sentence(error) else _GENERAL
    return _taken_for_another(owner) or _what_there_is(owner, name)


def _of_rclpy(error: BaseException) -> str:
    """Say why what a program calls once, for the whole of it, is not called by a controller."""
    names = [frame.f_code.co_name for frame in _frames(error) if _is_rclpy(frame)]
    return next((cause for name, cause in _PROGRAMS.items() if name in names), "")


def _is_rclpy(frame: FrameType) -> bool:
    return str(frame.f_globals.get("__name__", "")).partition(".")[0] == "rclpy"


def _taken_for_another(owner: Any) -> str:
    """Say what something is that was taken for an object with attributes; nothing if it is one."""
    if isinstance(owner, tuple):
        if any(isinstance(each, JointReport) for each in owner):
            return "match_joints returns two things: positions, report = match_joints(...)."
        return f"What stands before the dot is a tuple of {len(owner)} things: take them apart first."
    if isinstance(owner, (type, property, MemberDescriptorType)):
        return _CLASS.format(name=_class_name(owner))
    if isinstance(owner, (MethodType, FunctionType)):
        return f"Most likely parentheses are missing: {owner.__name__}()."
    return ""


def _unset(answer: type, name: str) -> str:
    """Say why the learner's object does not have an attribute."""
    for method in ("__init__", "configure", "initialize"):
        code = getattr(inspect.getattr_static(answer, method, None), "__code__", None)
        if code is not None and name in code.co_varnames[code.co_argcount :]:
            return f"Most likely self is missing in {method}: self.{name} = ..."
    keep = _KEEP.get(name)
    if keep is not None and not any(sets(member, name) for member in vars(answer).values()):
        return f"Most likely {keep[0]} does not keep it: {keep[1]}."
    return _UNSET + (_LIFE if issubclass(answer, SimpleController) else "let __init__ set it.")


def _what_there_is(owner: Any, name: str) -> str:
    there = [each for each in dir(owner) if each[0] != "_" and each.islower()]
    near = get_close_matches(name, there, n=1)
    if near:
        return f"Did you mean {near[0]!r}?"
    kind = type(owner).__name__
    has = [each for each in there if not each.startswith(("get_fields", "from_"))][:8]
    return f"{'An' if kind[0] in 'AEIO' else 'A'} {kind} has {', '.join(has)}." if has else _GENERAL


def _call(error: TypeError, answer: Any) -> str:
    text = sentence(error)
    function = blamed(error, answer)
    if function is not None:
        return no_self(function)
    known = next((cause for words, cause in _TYPES.items() if words in text), "")
    if known:
        return known
    found = _LACKING.search(text)
    return _GENERAL if found is None else _lacking(error, answer, found)


def _lacking(error: TypeError, answer: Any, found: re.Match[str]) -> str:
    """Say why something was called with too few arguments."""
    owner, _, name = found[1].rpartition(".")
    if name == "__init__" and isinstance(answer, type) and issubclass(answer, SimpleController):
        return NO_ARGUMENTS
    if found[2] == "'self'" and owner:
        return _CLASS.format(name=owner.rpartition(".")[2])
    frames = _frames(error)
    callback = _method(answer, found[1]) is not None and not hasattr(SimpleController, name)
    if callback and frames and frames[-1].f_code.co_name == "configure":
        return AT_ONCE.format(name=name)
    return _GENERAL


def _method(answer: Any, qualified: str) -> FunctionType | None:
    owner, _, name = qualified.rpartition(".")
    found = inspect.getattr_static(answer, name, None) if owner and isinstance(answer, type) else None
    return found if isinstance(found, FunctionType) else None


def _class_name(owner: Any) -> str:
    """Return the name of a class that was meant to be an object, from it or from one of its properties."""
    if isinstance(owner, property):
        if isinstance(owner.fget, FunctionType):
            return owner.fget.__qualname__.rpartition(".")[0]
        owner = getattr(owner.fget, "__self__", owner)
    owner = getattr(owner, "__objclass__", owner)
    return str(getattr(owner, "__name__", "the name"))


def _in_reach(error: BaseException) -> Iterator[Any]:
    """Yield the objects that the code which raised had at hand, the nearest first."""
    for frame in reversed(_frames(error)):
        values = list(frame.f_locals.values())
        yield from values
        for value in values:
            yield from getattr(value, "__dict__", {}).values()


def _frames(error: BaseException) -> list[FrameType]:
    return [frame for frame, _ in walk_tb(error.__traceback__)]
