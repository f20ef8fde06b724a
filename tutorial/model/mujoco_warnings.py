"""Sends MuJoCo's warnings to the log.

By default, MuJoCo prints its warnings, and appends them to MUJOCO_LOG.TXT in the current folder.
"""

import logging
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress

WARN_EVERY = 5.0  # [s] between log lines
AFTER_WARNING = {
    " in CTRL at ": "All controls are treated as 0 until all of them are valid again.",
    " in Q": "The simulated world is reset to its initial state.",  # matches QPOS, QVEL and QACC
}
"""What MuJoCo does without mentioning it in the warning, keyed by a part of the warning's text."""

IN_OTHER_WORDS = {
    "Attach conflict": (
        "a model file attaches another file whose options differ. The attached file's options are not used."
    ),
}
"""Replacements for warnings that only MuJoCo's own developers understand, keyed by the beginning of the warning."""

_log = logging.getLogger(__name__)


class _MujocoWarns:
    """Logs MuJoCo's warnings, at most one line per `WARN_EVERY`. Thread-safe."""

    def __init__(self) -> None:
        self._unsaid = 0
        self._due = 0.0

    def __call__(self, text: str) -> None:
        """Log a warning, or only count it if the last log line is too recent. The next log line reports the count."""
        with suppress(BaseException):  # an exception that reaches MuJoCo, which is C++, would end the process
            now = time.monotonic()
            if now < self._due:
                self._unsaid += 1
                return
            follows = next((f" {what}" for where, what in AFTER_WARNING.items() if where in text), "")
            others = f" ({self._unsaid} more since the last warning)" if self._unsaid else ""
            self._unsaid, self._due = 0, now + WARN_EVERY
            ours = next((said for begin, said in IN_OTHER_WORDS.items() if text.startswith(begin)), "")
            _log.warning("%s%s", ours or f"MuJoCo: {text.strip()}{follows}", others)


mujoco_warns = _MujocoWarns()
"""The handler for MuJoCo's warnings, shared by the whole process."""


@contextmanager
def no_python_warnings() -> Iterator[None]:
    """Suppress MuJoCo's Python warnings, which would point at this project's code. `mujoco_warns` logs them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
