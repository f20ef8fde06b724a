"""What the learner's code does beside its work: it sleeps, asks the computer's clock, or starts a thread."""

from __future__ import annotations

import functools
import queue
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import _base as futures
from concurrent.futures import thread as pools
from contextlib import contextmanager
from typing import Any

from tutorial.checks._watch import watch

__all__ = ["witnessed"]

CLOCKS = ("time", "time_ns", "monotonic", "monotonic_ns", "perf_counter", "perf_counter_ns")

_BETWEEN = {module.__file__ for module in (threading, queue, futures, pools)}
_held = 0


@contextmanager
def witnessed() -> Iterator[None]:
    """Have `watch` note what the learner's code does with time and threads, as long as ``with`` lasts.

    Functions of the modules `time` and `threading` are replaced; everybody else's calls go through as they are.
    """
    global _held  # noqa: PLW0603 - nested, only the outermost replaces anything
    _held += 1
    replaced = _replacements() if _held == 1 else []
    for owner, name, _, new in replaced:
        setattr(owner, name, new)
    try:
        yield
    finally:
        _held -= 1
        for owner, name, old, _ in replaced:
            setattr(owner, name, old)


def _replacements() -> list[tuple[Any, str, Any, Any]]:
    """List what is replaced: of which module or class, its name, what it was and what it becomes."""
    found: list[tuple[Any, str, Callable[..., Any]]] = [
        (time, "sleep", _noting("sleep")),
        (threading.Condition, "wait", _noting("sleep")),
        (threading.Thread, "start", _noting("thread")),
        *((time, name, _asking(name)) for name in CLOCKS),
    ]
    return [(owner, name, getattr(owner, name), wrap(getattr(owner, name))) for owner, name, wrap in found]


def _noting(what: str) -> Callable[..., Any]:
    def wrap(function: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(function)
        def noting(*args: Any, **kwargs: Any) -> Any:
            if _is_learners():
                watch.note(what, sys._getframe(1))
            return function(*args, **kwargs)

        return noting

    return wrap


def _asking(name: str) -> Callable[..., Any]:
    unit = 1_000_000_000 if name.endswith("_ns") else 1  # in a second

    def wrap(clock: Callable[[], float]) -> Callable[..., Any]:
        @functools.wraps(clock)
        def asking() -> float:
            if sys._getframe(1).f_code.co_filename in watch.files:
                watch.note("clock", sys._getframe(1))
                if watch.clocks is not None:
                    return watch.clocks.setdefault(name, clock() + round(watch.ahead * unit))
            return clock()

        return asking

    return wrap


def _is_learners() -> bool:
    """Whether the learner's code has called, be it by way of another function of the same library."""
    frame = sys._getframe(2)
    while frame.f_code.co_filename in _BETWEEN and frame.f_back is not None:
        frame = frame.f_back
    return frame.f_code.co_filename in watch.files
