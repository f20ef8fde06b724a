"""What the tests do to themselves."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from tutorial.paths import HOME

INTERRUPTED = "import signal; signal.raise_signal(signal.SIGINT)"


def run(*command):
    return subprocess.run(command, cwd=HOME, capture_output=True, text=True, check=False)


@pytest.mark.process
def test_what_a_test_starts_can_be_interrupted():
    assert run(sys.executable, "-c", INTERRUPTED).returncode == -signal.SIGINT


@pytest.mark.process
def test_so_it_can_where_the_tests_run_in_the_background_of_a_shell():
    one = f"{__file__}::{test_what_a_test_starts_can_be_interrupted.__name__}"
    pytest_ = (sys.executable, "-m", "pytest", "-p", "no:cacheprovider", one)
    done = run("sh", "-c", 'trap "" INT; exec "$@"', "sh", *pytest_)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 passed" in done.stdout
