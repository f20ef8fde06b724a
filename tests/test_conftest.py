"""What the tests do to themselves."""

from __future__ import annotations

import subprocess
import sys

from tutorial.paths import HOME

IN_THE_BACKGROUND = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_IGN)
os.execv(sys.executable, [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--timeout=60", *sys.argv[1:]])
"""


def test_what_they_start_can_be_interrupted_though_they_run_in_the_background():
    one = "tests/checks/test_contain.py::test_an_interrupt_ends_the_process_and_is_passed_on"
    command = [sys.executable, "-c", IN_THE_BACKGROUND, one]
    done = subprocess.run(command, cwd=HOME, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 passed" in done.stdout
