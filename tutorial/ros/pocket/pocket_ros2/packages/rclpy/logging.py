"""Write log lines to stderr as ROS 2 does: ``[INFO] [1700000000.123456789] [node]: text``."""

from __future__ import annotations

import sys
import threading
import time
import weakref
from dataclasses import dataclass
from enum import IntEnum
from math import inf
from types import FrameType
from typing import Any, Protocol


class LoggingSeverity(IntEnum):
    """Severity of a log line."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50


class Listener(Protocol):
    """A receiver of log lines from a logger and its children, such as a node that publishes them on ``/rosout``."""

    def publish_log(self, severity: LoggingSeverity, name: str, text: str) -> None:
        """Receive a line; called on the thread that logs."""


listeners: weakref.WeakValueDictionary[str, Listener] = weakref.WeakValueDictionary()
"""Listeners by logger name."""

muting: weakref.WeakSet[object] = weakref.WeakSet()
"""Running contexts with ``--disable-stdout-logs``. While any such context runs, nothing is logged to stderr."""

FILTERS = {
    "throttle": ("throttle_duration_sec", "throttle_time_source_type"),
    "skip_first": ("skip_first",),
    "once": ("once",),
}
"""Options of each filter, in the order the filters are applied."""
OPTIONS = [option for options in FILTERS.values() for option in options]

_levels: dict[str, LoggingSeverity] = {"": LoggingSeverity.INFO}
_lock = threading.RLock()


@dataclass
class _Place:
    """A line of code that logs: the arguments of its first call, and the state of its filters."""

    asked: tuple[LoggingSeverity, str, list[str], dict[str, Any]]
    last_logged: float = -inf  # `time.monotonic` can be near 0 just after boot
    skipped: bool = False
    logged: bool = False

    def is_due(self) -> bool:
        """Return whether the filters let a line through, and update their state."""
        _, _, filters, options = self.asked
        if "throttle" in filters:
            now = time.monotonic()
            if now < self.last_logged + options["throttle_duration_sec"]:
                return False
            self.last_logged = now
        if "skip_first" in filters and not self.skipped:
            self.skipped = True
            return False
        if "once" in filters:
            logged, self.logged = self.logged, True
            return not logged
        return True


class RcutilsLogger:
    """Writes log lines under a name; can be used from any thread.

    The method for each severity takes the text and the options ``throttle_duration_sec`` [s], ``skip_first`` and
    ``once``, which apply separately to each line of code that logs.
    """

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._places: dict[tuple[str, str, int, int], _Place] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """Return the logger ``NAME.CHILD``."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: LoggingSeverity | int) -> None:
        """Drop lines below this severity."""
        set_logger_level(self.name, level)

    def get_effective_level(self) -> LoggingSeverity:
        """Return the severity below which lines are dropped: this logger's own level, or the nearest parent's level."""
        return get_logger_effective_level(self.name)

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Return whether a line of this severity would be written."""
        return LoggingSeverity(severity) >= self.get_effective_level()

    def debug(self, message: str, **kwargs: Any) -> bool:
        """Log details for developers."""
        return self.log(message, LoggingSeverity.DEBUG, **kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        """Log normal operation."""
        return self.log(message, LoggingSeverity.INFO, **kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        """Log a possible problem."""
        return self.log(message, LoggingSeverity.WARN, **kwargs)

    warn = warning

    def error(self, message: str, **kwargs: Any) -> bool:
        """Log an error."""
        return self.log(message, LoggingSeverity.ERROR, **kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        """Log an error that ends the program."""
        return self.log(message, LoggingSeverity.FATAL, **kwargs)

    def log(self, message: str, severity: LoggingSeverity | int, **kwargs: Any) -> bool:
        """Write one line, and return whether it was written.

        Raises:
            TypeError: the message is not a string, or an option is unknown.
            ValueError: the calling line of code has logged before, but with different options.
        """
        severity = LoggingSeverity(severity)
        name = kwargs.pop("name", self.name)
        asked = (severity, name, _filters(kwargs), kwargs)
        with _lock:
            place = self._places.setdefault(_caller(sys._getframe(1)), _Place(asked))
            if place.asked != asked:
                raise ValueError(_change(place.asked, asked))
            if not self.is_enabled_for(severity) or not place.is_due():
                return False
        if not isinstance(message, str):
            raise TypeError(f"rclpy_logging_rcutils_log(): incompatible function arguments: {message!r} is no str")
        _write(severity, name, message)
        return True


def get_logger(name: str) -> RcutilsLogger:
    """Return the logger with the given name."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return RcutilsLogger(name)


def set_logger_level(name: str, level: LoggingSeverity | int, detailed_error: bool = False) -> None:  # noqa: ARG001
    """Set the lowest severity that a logger writes; "" is the parent of all loggers."""
    _levels[name] = LoggingSeverity(level)


def get_logger_level(name: str) -> LoggingSeverity:
    """Return a logger's own level, or ``UNSET`` if it has none."""
    return _levels.get(name, LoggingSeverity.UNSET)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the level of a logger or, if it has none, of its nearest parent with a level."""
    while name and not _levels.get(name):
        name = name.rpartition(".")[0]
    return _levels[name] or LoggingSeverity.INFO


def _filters(options: dict[str, Any]) -> list[str]:
    """Return the filters that the options select."""
    filters = [name for name, params in FILTERS.items() if any(options.get(param) for param in params)]
    if "throttle" in filters and "throttle_duration_sec" not in options:
        raise TypeError(
            'required parameter "throttle_duration_sec" not specified but is required for the the logging filter '
            '"throttle"'
        )
    for option in options:
        if option not in OPTIONS:
            raise TypeError(f'parameter "{option}" is not one of the recognized logging options "{OPTIONS}"')
    return filters


def _change(before: tuple[Any, ...], now: tuple[Any, ...]) -> str:
    """Return the error message for a line of code whose logging options have changed."""
    things = ("Logger severity", "Logger name", "Requested logging filters", "Logging filter parameters")
    return next(f"{thing} cannot be changed between calls." for thing, a, b in zip(things, before, now) if a != b)


def _caller(frame: FrameType | None) -> tuple[str, str, int, int]:
    """Return where the logger was called from: the first frame outside this module."""
    while frame is not None and frame.f_code.co_filename == __file__:
        frame = frame.f_back
    assert frame is not None
    return frame.f_code.co_name, frame.f_code.co_filename, frame.f_lineno, frame.f_lasti


def _write(severity: LoggingSeverity, name: str, text: str) -> None:
    seconds, nanoseconds = divmod(time.time_ns(), 1_000_000_000)
    stream = sys.stderr
    if stream is not None and not muting:  # pythonw has no stderr
        with _lock:
            stream.write(f"[{severity.name}] [{seconds}.{nanoseconds:09d}] [{name}]: {text}\n")
            stream.flush()
    owner = name
    while owner and owner not in listeners:
        owner = owner.rpartition(".")[0]
    if listener := listeners.get(owner):
        listener.publish_log(severity, name, text)
