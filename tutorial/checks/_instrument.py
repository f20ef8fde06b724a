"""`time` and `threading`, instrumented: they note that the learner's code sleeps, asks a clock or starts a thread."""

from __future__ import annotations

import functools
import queue
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import _base as futures
from concurrent.futures import thread as pools
from contextlib import ExitStack, contextmanager
from typing import Any

from tutorial.checks._watch import watch

__all__ = ["instrumented"]

CLOCKS = ("time", "time_ns", "monotonic", "monotonic_ns", "perf_counter", "perf_counter_ns")
NOTED = (
    *((time, "sleep", "sleep"), (threading.Condition, "wait", "sleep"), (threading.Thread, "start", "thread")),
    *((time, name, "clock") for name in CLOCKS),
)
"""What is noted: a module or class, the name of its function, and what `watch` calls it."""

_BETWEEN = {module.__file__ for module in (threading, queue, futures, pools)}


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

    @functools.wraps(function)
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
