"""Log lines on stderr, as ROS 2 writes them: ``[INFO] [1700000000.123456789] [node]: text``."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable
from enum import IntEnum
from typing import Any

__all__ = [
    "LoggingSeverity",
    "RcutilsLogger",
    "get_logger",
    "get_logger_effective_level",
    "get_logger_level",
    "set_logger_level",
]


class LoggingSeverity(IntEnum):
    """How much a log line matters."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50


_levels: dict[str, LoggingSeverity] = {"": LoggingSeverity.INFO}
_lock = threading.RLock()
_listeners: dict[str, Callable[[LoggingSeverity, str, str], None]] = {}


class RcutilsLogger:
    """Writes log lines under a name; may be called from any thread.

    Every severity's method takes the text, and as options ``throttle_duration_sec`` [s], ``skip_first`` and ``once``,
    which count for each line of the program that logs.
    """

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._last_logged: dict[tuple[str, int], float] = {}

    def get_child(self, name: str) -> RcutilsLogger:
        """Return the logger ``NAME.CHILD``."""
        return get_logger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: LoggingSeverity | int) -> None:
        """Drop lines below this severity."""
        set_logger_level(self.name, level)

    def get_effective_level(self) -> LoggingSeverity:
        """Return the severity below which lines are dropped: this logger's own, or the nearest parent's."""
        return get_logger_effective_level(self.name)

    def is_enabled_for(self, severity: LoggingSeverity | int) -> bool:
        """Whether a line of this severity would be written."""
        return severity >= self.get_effective_level()

    def debug(self, message: str, **options: Any) -> bool:
        """Log what only a developer wants to see."""
        return self.log(message, LoggingSeverity.DEBUG, **options)

    def info(self, message: str, **options: Any) -> bool:
        """Log what is normal."""
        return self.log(message, LoggingSeverity.INFO, **options)

    def warning(self, message: str, **options: Any) -> bool:
        """Log what may be a mistake."""
        return self.log(message, LoggingSeverity.WARN, **options)

    warn = warning

    def error(self, message: str, **options: Any) -> bool:
        """Log what went wrong."""
        return self.log(message, LoggingSeverity.ERROR, **options)

    def fatal(self, message: str, **options: Any) -> bool:
        """Log what ends the program."""
        return self.log(message, LoggingSeverity.FATAL, **options)

    def log(
        self,
        message: str,
        severity: LoggingSeverity | int,
        *,
        throttle_duration_sec: float | None = None,
        skip_first: bool = False,
        once: bool = False,
    ) -> bool:
        """Write one line, and return whether it was written."""
        severity = LoggingSeverity(severity)
        if not self.is_enabled_for(severity):
            return False
        limited = once or skip_first or throttle_duration_sec is not None
        if limited and not self._is_due(throttle_duration_sec, skip_first, once):
            return False
        _write(severity, self.name, str(message))
        return True

    def _is_due(self, throttle: float | None, skip_first: bool, once: bool) -> bool:
        """Decide for a line of the program that has options whether it may log now."""
        frame = sys._getframe(3 if sys._getframe(2).f_code.co_filename == __file__ else 2)
        place = (frame.f_code.co_filename, frame.f_lineno)
        now = time.monotonic()
        with _lock:
            last = self._last_logged.get(place)
            first = last is None
            due = not skip_first if last is None else not once and now - last >= (throttle or 0.0)
            if due or first:
                self._last_logged[place] = now
        return due


_loggers: dict[str, RcutilsLogger] = {}


def get_logger(name: str) -> RcutilsLogger:
    """Return the logger of a name."""
    return _loggers.setdefault(name, RcutilsLogger(name))


def set_logger_level(name: str, level: LoggingSeverity | int) -> None:
    """Drop a logger's lines below this severity; "" is the parent of all loggers."""
    _levels[name] = LoggingSeverity(level)


def get_logger_level(name: str) -> LoggingSeverity:
    """Return the logger's own level, ``UNSET`` if it has none."""
    return _levels.get(name, LoggingSeverity.UNSET)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """Return the level of the logger or of its nearest parent that has one."""
    while name and not _levels.get(name):
        name = name.rpartition(".")[0]
    return _levels[name]


def set_listener(name: str, listener: Callable[[LoggingSeverity, str, str], None] | None) -> None:
    """Pass a logger's lines, and those of its children, on: this is how a node's log reaches ``/rosout``.

    Args:
        name: of the logger.
        listener: called with severity, logger's name and text, on the thread that logs; None ends it.
    """
    if listener is None:
        _listeners.pop(name, None)
    else:
        _listeners[name] = listener


def _write(severity: LoggingSeverity, name: str, text: str) -> None:
    seconds, nanoseconds = divmod(time.time_ns(), 1_000_000_000)
    line = f"[{severity.name}] [{seconds}.{nanoseconds:09d}] [{name}]: {text}\n"
    stream = sys.stderr
    if stream is not None:  # pythonw has none
        with _lock:
            stream.write(line)
            stream.flush()
    owner = name
    while owner and owner not in _listeners:
        owner = owner.rpartition(".")[0]
    if listener := _listeners.get(owner):
        listener(severity, name, text)
