"""Instruments, which record how the learner's code uses time and threads and can stop its clocks."""

import queue
import sys
import threading
import time
from collections.abc import Callable, Collection, Hashable
from concurrent.futures import _base as futures
from concurrent.futures import thread as pools
from contextlib import ExitStack
from functools import wraps
from types import FrameType
from typing import Any, Self

from tutorial.checks.engine.trial import Trial

CLOCKS = ("time", "time_ns", "monotonic", "monotonic_ns", "perf_counter", "perf_counter_ns")
NOTED = (
    *((time, "sleep", "sleep"), (threading.Condition, "wait", "sleep"), (threading.Thread, "start", "thread")),
    *((time, name, "clock") for name in CLOCKS),
)
"""The recorded functions, each with its module or class, its name, and its key in `Trial.noted`."""

_BETWEEN = {module.__file__ for module in (threading, queue, futures, pools)}


class Instruments:
    """Inside a ``with`` block, replace functions of `time` and `threading` to record the learner's calls in the trial.

    Calls from any other code are passed on unchanged.

    Attributes:
        trial: the current trial, None before the first one.
    """

    def __init__(self) -> None:
        self.trial: Trial | None = None
        self._kept = dict[Hashable, Any]()
        self._replaced = ExitStack()

    def __enter__(self) -> Self:
        for owner, name, what in NOTED:
            function = getattr(owner, name)
            self._replaced.callback(setattr, owner, name, function)
            setattr(owner, name, self._noting(what, name, function))
        return self

    def __exit__(self, *_: object) -> None:
        self._replaced.close()

    def begin(self, answer: Any, watched: Collection[str] | None = None, is_timed: bool = True) -> Trial:
        """Begin a new trial, and make it the current one. See `Trial` for the arguments."""
        self.trial = Trial(answer, watched, is_timed, self._kept)
        return self.trial

    def _noting(self, what: str, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap a function to record the learner's calls.

        A clock that the trial has stopped stands still only for the learner's calls.
        """

        @wraps(function)
        def noting(*args: Any, **kwargs: Any) -> Any:
            trial, frame = self.trial, _caller()
            if trial is None or frame.f_code.co_filename not in trial.watched:
                return function(*args, **kwargs)
            trial.note(what, frame)
            if what != "clock" or trial.clocks is None:
                return function(*args, **kwargs)
            ahead = round(trial.ahead * 1e9) if name.endswith("_ns") else trial.ahead
            return trial.clocks.setdefault(name, function()) + ahead

        return noting


def _caller() -> FrameType:
    """Return the caller's frame, skipping the frames of the replaced functions' own libraries."""
    frame = sys._getframe(2)
    while frame.f_code.co_filename in _BETWEEN and frame.f_back is not None:
        frame = frame.f_back
    return frame
