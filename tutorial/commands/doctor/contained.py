"""Asking a question in a process of its own: what crashes or hangs there is only an answer that did not come."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping
from typing import Any

from tutorial.errors import TutorialError
from tutorial.paths import PACKAGE

__all__ = ["PATIENCE", "Ask", "UnansweredError", "ask"]

PATIENCE = 30.0  # [s] that an answer may take: a loaded machine is slow to import

Ask = Callable[[str, Mapping[str, str]], Any]
"""What `ask` is to those who use it: tests have answers of their own."""


class UnansweredError(TutorialError):
    """No answer came; the text says why."""


def ask(question: str, environment: Mapping[str, str], patience: float = PATIENCE) -> Any:
    """Have a question answered by ``tutorial.commands.doctor._child``.

    Args:
        question: one that it knows.
        environment: of that process.
        patience: how long it may take [s].

    Raises:
        UnansweredError: it crashed, failed, or took too long.
    """
    path = os.pathsep.join(filter(None, (str(PACKAGE.parent), environment.get("PYTHONPATH"))))
    try:
        process = subprocess.run(
            [sys.executable, "-P", "-m", "tutorial.commands.doctor._child", question],
            env={**environment, "PYTHONPATH": path, "PYTHONUTF8": "1"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=patience,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise UnansweredError(f"no answer within {patience:g} s") from None
    if process.returncode < 0:
        raise UnansweredError(f"crashed with {signal.Signals(-process.returncode).name}")
    if process.returncode > 0:
        raise UnansweredError(_last_line(process.stderr) or f"exit status {process.returncode}")
    return json.loads(_last_line(process.stdout))


def _last_line(text: str) -> str:
    return next((line.strip() for line in reversed(text.splitlines()) if line.strip()), "")
