"""Handle Ctrl-C (SIGINT) and SIGTERM."""

import signal
import threading
from enum import IntFlag
from types import FrameType
from typing import Any

from rclpy.context import stop_all


class SignalHandlerOptions(IntFlag):
    """Signals that shut down all contexts."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_SIGNALS = {SignalHandlerOptions.SIGINT: signal.SIGINT, SignalHandlerOptions.SIGTERM: signal.SIGTERM}
_previous: dict[int, Any] = {}


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Shut down all contexts when one of these signals arrives.

    Python allows signal handlers to be set only on the main thread; on any other thread, this function has no effect.
    The previous handlers are still called, so Ctrl-C still raises KeyboardInterrupt.
    """
    if threading.current_thread() is threading.main_thread():
        for option, number in _SIGNALS.items():
            if option in options and number not in _previous:
                _previous[number] = signal.signal(number, _on_signal)


def uninstall_signal_handlers() -> None:
    """Restore the previous handlers, unless this module's handlers have been replaced since."""
    if threading.current_thread() is threading.main_thread():
        for number in list(_previous):
            previous = _previous.pop(number)
            if signal.getsignal(number) is _on_signal:
                signal.signal(number, previous)


def _on_signal(number: int, frame: FrameType | None) -> None:
    stop_all()
    previous = _previous.get(number)
    if callable(previous):
        previous(number, frame)
