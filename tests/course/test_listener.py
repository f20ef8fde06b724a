"""The node that stands without the course, as a program of its own."""

from __future__ import annotations

import signal
import subprocess
import sys

import pytest

from tutorial.paths import HOME

AS_IT_IS = ["listener.py"]
WITH_THE_COURSE = ["-c", "import tutorial; exec(open('listener.py').read())"]


@pytest.mark.parametrize("arguments", [AS_IT_IS, WITH_THE_COURSE])
def test_it_says_where_the_joints_are_until_ctrl_c(program, backend, arguments):
    if backend == "underlay" and arguments == AS_IT_IS:
        pytest.skip("it takes an installed ROS 2 to run it as it is")
    running = program("run", "step2", "--headless")
    command = [sys.executable, *arguments]
    with subprocess.Popen(command, cwd=HOME / "notebooks", stderr=subprocess.PIPE, text=True) as listener:
        said = next(line for line in listener.stderr if "TURRET_P -0.01" in line)
        listener.send_signal(signal.SIGINT)
        assert "Traceback" not in listener.stderr.read()
    assert listener.returncode == 0
    assert said.endswith("[listener]: TURRET_Y 0.00, TURRET_P -0.01\n")
    running.asks_to_stop()
    assert running.ends() == 0
