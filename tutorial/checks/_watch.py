"""Whose turn it is: which of the learner's methods runs, on which thread, how it uses time, and what came of it."""

import queue
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import _base as futures
from concurrent.futures import thread as pools
from contextlib import ExitStack, contextmanager
from functools import wraps
from itertools import count
from traceback import walk_stack, walk_tb
from types import FrameType, FunctionType
from typing import Any

from tutorial.checks._diagnose import likely_cause, slept
from tutorial.checks._verdict import Finding, Place, wrong

CLOCKS = ("time", "time_ns", "monotonic", "monotonic_ns", "perf_counter", "perf_counter_ns")
NOTED = (
    *((time, "sleep", "sleep"), (threading.Condition, "wait", "sleep"), (threading.Thread, "start", "thread")),
    *((time, name, "clock") for name in CLOCKS),
)
"""What is noted: a module or class, the name of its function, and what `watch` calls it."""

_BETWEEN = {module.__file__ for module in (threading, queue, futures, pools)}


class Misuse(Exception):  # noqa: N818 - not an error of this library, but of the learner's code
    """Something was called in a way that cannot work, and it is known why.

    Args:
        text: what was done.
        cause: the most likely cause, as a sentence.
    """

    def __init__(self, text: str, cause: str) -> None:
        super().__init__(text)
        self.cause = cause


class Failure(Exception):  # noqa: N818 - not an error of this library, but of the learner's code
    """One of the learner's methods raised.

    Args:
        method: its name.
        error: what it raised.
        place: the innermost line of the learner's code.
    """

    def __init__(self, method: str, error: BaseException, place: Place | None = None) -> None:
        super().__init__(f"{method} raised {type(error).__name__}")
        self.method = method
        self.error = error
        self.place = place

    @property
    def kind(self) -> tuple[type[BaseException], str]:
        """What two failures have in common that are the same observation.

        A `Misuse` has a cause, too, and a call without an argument that is required has the method.
        """
        called_in = self.method * ("required positional argument" in str(self.error))
        return type(self.error), getattr(self.error, "cause", called_in)

    def finding(self, cause: str | None = None, when: str = "") -> Finding:
        """Say what happened, and what most likely caused it.

        Args:
            cause: the most likely cause; None for what is known of this kind of exception in general.
            when: what was looked at.
        """
        first, *_ = [*str(self.error).strip().splitlines(), ""]
        text = f"{self.method} raised {type(self.error).__name__}: {first}".removesuffix(": ")
        if isinstance(self.error, Misuse):
            text, cause = f"{self.method}: {self.error}", cause or self.error.cause
        cause = likely_cause(self.error, watch.answer) if cause is None else cause
        return wrong(f"{when}: {text}" if when else text, cause, self.place)


class Watch:
    """Knows which of the learner's methods are running.

    Attributes:
        answer: the learner's class or function.
        files: where the learner's code is.
        running: by thread, the methods that run, the innermost last, each with a number that every call has anew.
        noted: what the learner's code has done beside its work, and where: ``"sleep"``, ``"clock"``, ``"thread"``,
            ``"timer"``.
        clocks: by name, where the clocks of `time` stand still for the learner's code; None while they go.
        ahead: by how much they have been put ahead since [s].
        interleaved: whether methods are being held up on purpose, so that how long they take says nothing.
        explaining: whether mistakes are tried, and so all calls together may take long.
    """

    def __init__(self) -> None:
        self.answer: Any = None
        self.files: set[str] = set()
        self.running = defaultdict[int, list[tuple[str, int]]](list)
        self.noted: dict[str, Place | None] = {}
        self.clocks: dict[str, float] | None = None
        self.ahead = 0.0
        self.interleaved = self.explaining = False
        self._numbers = count()

    def begin(self, answer: Any) -> None:
        """Watch an answer: nothing of it has been run yet."""
        self.answer, self.files, self.explaining = answer, files_of(answer), False
        self.noted.clear()

    @contextmanager
    def call(self, method: str) -> Iterator[None]:
        """Run one of the learner's methods. Any thread.

        Raises:
            Failure: it raised, whatever it was; or it has slept, which no method may.
        """
        calls = self.running[threading.get_ident()]
        calls.append((method, next(self._numbers)))
        try:
            yield
            self._check_slept(method)
        except Failure:
            raise
        except BaseException as error:
            self._check_slept(method)  # what it was to wait for has not come
            raise self.failure(method, error) from error
        finally:
            calls.pop()

    def _check_slept(self, method: str) -> None:
        if "sleep" in self.noted:
            raise Failure(method, Misuse("it sleeps", slept(method)), self.noted.pop("sleep"))

    def failure(self, method: str, error: BaseException) -> Failure:
        """Tell with an exception where in the learner's code it was raised."""
        return Failure(method, error, self.place(reversed([*walk_tb(error.__traceback__)])))

    def note(self, what: str, frame: FrameType) -> None:
        """Note what the learner's code does; a sleep only on a thread that runs one of the methods."""
        if what != "sleep" or self.running[threading.get_ident()]:
            self.noted.setdefault(what, self.place(walk_stack(frame)))

    @contextmanager
    def clocks_stand(self, ahead: float = 0.0) -> Iterator[None]:
        """Have the clocks of `time` stand still for the learner's code.

        Args:
            ahead: by how much they are put ahead before [s].
        """
        self.clocks, self.ahead = {}, ahead
        try:
            yield
        finally:
            self.clocks = None

    def place(self, stack: Iterable[tuple[FrameType, int]]) -> Place | None:
        """Find the innermost line of the learner's code on a stack, the innermost frames first."""
        found = ((frame.f_code, line) for frame, line in stack if frame.f_code.co_filename in self.files)
        return next((Place(code.co_filename, line, code.co_name) for code, line in found), None)


watch = Watch()
"""The one of this process."""

_OURS = ("builtins", "tutorial.controller")


def classes_of(answer: Any) -> list[type]:
    """Return the classes that an answer is made of: a class itself, or that of an object, and those it is made from."""
    kind = answer if isinstance(answer, type) else type(answer)
    return [each for each in kind.__mro__ if each.__module__ not in _OURS]


def functions_of(answer: Any) -> list[FunctionType]:
    """Return the functions that an answer is made of, such as the methods of a class."""
    members = (member for each in classes_of(answer) for member in vars(each).values())
    found = (getattr(each, "__func__", each) for each in (answer, *members))
    return [each for each in found if isinstance(each, FunctionType)]


def files_of(answer: Any) -> set[str]:
    """Return the files, or notebook cells, that an answer's functions are written in."""
    return {function.__code__.co_filename for function in functions_of(answer)}


@contextmanager
def instrumented() -> Iterator[None]:
    """Have `watch` note what the learner's code does with time and threads, as long as ``with`` lasts.

    Functions of the modules `time` and `threading` are replaced; everybody else's calls go through as they are.
    """
    with ExitStack() as stack:
        for owner, name, what in NOTED:
            function = getattr(owner, name)
            stack.callback(setattr, owner, name, function)
            setattr(owner, name, _noting(what, name, function))
        yield


def _noting(what: str, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a function, so that it notes the learner's calls. A clock stands still for them while `watch` says so."""

    @wraps(function)
    def noting(*args: Any, **kwargs: Any) -> Any:
        frame = sys._getframe(1)
        while frame.f_code.co_filename in _BETWEEN and frame.f_back is not None:
            frame = frame.f_back  # the learner's code calls by way of another function of the same library
        if frame.f_code.co_filename in watch.files:
            watch.note(what, frame)
            if what == "clock" and watch.clocks is not None:
                ahead = round(watch.ahead * 1e9) if name.endswith("_ns") else watch.ahead
                return watch.clocks.setdefault(name, function()) + ahead
        return function(*args, **kwargs)

    return noting
