"""Two processes of Python: one that publishes, and one that measures what it receives."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

HERE = Path(__file__).parent
REAL = shlex.split(os.environ.get("TANK_REAL_ROS2", ""))
"""A command that runs another one with a real ROS 2, where there is one."""


def measured(program: str, *how: str, by: Sequence[str] = (), published_by: Sequence[str] | None = None) -> float:
    """Run ``program publish`` and ``program subscribe``, and return what the latter prints [s].

    Args:
        program: the file's name.
        how: further arguments of both.
        by: a command that runs others, such as `REAL`.
        published_by: the same for the publisher; None for that of both.
    """
    command = [sys.executable, str(HERE / program)]
    publishing = [*(by if published_by is None else published_by), *command, "publish", *how]
    with (
        subprocess.Popen(publishing) as publisher,
        subprocess.Popen([*by, *command, "subscribe", *how], stdout=subprocess.PIPE, text=True) as subscriber,
    ):
        try:
            return float(subscriber.communicate(timeout=120)[0])
        finally:
            subscriber.kill()
            publisher.kill()
