"""Launch files without ROS: processes that end together, whatever happens."""

from __future__ import annotations

import signal

import pytest

from tutorial.errors import TutorialError
from tutorial.launcher import load_launch_file
from tutorial.paths import find_launch_file

SLEEPER = ["python3", "-c", "import time; print('asleep', flush=True); time.sleep(300)"]
STUBBORN = [
    "python3",
    "-c",
    "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); print('stubborn', flush=True); time.sleep(300)",
]


@pytest.fixture
def launch_file(tmp_path):
    """Write a launch file that runs commands, given by name."""

    def write(**commands):
        path = tmp_path / "test.launch.py"
        processes = ", ".join(f"ExecuteProcess(name={name!r}, cmd={cmd!r})" for name, cmd in commands.items())
        path.write_text(
            "from launch import LaunchDescription\n"
            "from launch.actions import ExecuteProcess\n"
            f"def generate_launch_description():\n    return LaunchDescription([{processes}])\n"
        )
        return path

    return write


@pytest.mark.parametrize(
    ("step", "names"),
    [
        ("step1", ["joystick", "simulation"]),
        ("step2", ["joystick", "simulation"]),
        ("step3", ["joystick", "simulation", "viewer"]),
    ],
)
def test_the_steps_launch_files_list_their_processes(step, names):
    processes = load_launch_file(find_launch_file(step))
    assert [process.name for process in processes] == names
    assert all(process.cmd[0] == "tank" for process in processes)
    assert all(f"__node:={process.name}" in process.cmd for process in processes)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("from launch.substitutions import X", "needs"),
        ("x = 1", "has no function generate_launch_description()"),
        ("def generate_launch_description(): 1 / 0", "ZeroDivisionError"),
        ("def generate_launch_description(", "SyntaxError"),
    ],
)
def test_a_bad_launch_file_says_what_is_wrong(tmp_path, text, said):
    path = tmp_path / "bad.launch.py"
    path.write_text(text)
    with pytest.raises(TutorialError) as info:
        load_launch_file(path)
    assert str(path) in str(info.value)
    assert said in str(info.value) or "ROS 2" in str(info.value)


def test_lines_have_the_process_in_front(program, launch_file):
    running = program("launch", launch_file(one=["echo", "hello"], another=["echo", "world"]))
    assert running.ends() == 0
    assert "one     | hello" in running.output
    assert "another | world" in running.output


def test_when_one_fails_the_others_are_stopped_and_its_status_is_the_exit_status(program, launch_file):
    failing = ["python3", "-c", "import sys; sys.exit(3)"]
    running = program("launch", launch_file(sleeper=SLEEPER, failing=failing))
    assert running.ends() == 3
    assert "failing | failed with exit status 3; the others are stopped" in running.output
    running.leaves_nothing()


def test_a_command_that_there_is_not_is_said(program, launch_file):
    running = program("launch", launch_file(sleeper=SLEEPER, missing=["no-such-command"]))
    assert running.ends() == 127
    assert "no-such-command could not be started: No such file or directory" in running.output
    running.leaves_nothing()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_asked_to_stop_it_stops_all(program, launch_file, number):
    running = program("launch", launch_file(one=SLEEPER, other=SLEEPER))
    running.says("one   | asleep")
    running.says("other | asleep")
    running.process.send_signal(number)
    assert running.ends() == 0
    running.leaves_nothing()


def test_who_does_not_stop_when_asked_is_killed(program, launch_file):
    running = program("launch", launch_file(one=STUBBORN))
    running.says("stubborn")
    running.asks_to_stop()
    running.says("did not stop within")
    running.ends()
    running.leaves_nothing()


def test_nothing_outlives_a_launcher_that_is_killed(program, launch_file):
    running = program("launch", launch_file(one=SLEEPER, other=STUBBORN))
    running.says("asleep")
    running.says("stubborn")
    running.process.kill()
    running.leaves_nothing()


def test_a_process_that_is_killed_has_failed(program, launch_file):
    running = program("launch", launch_file(one=SLEEPER, other=SLEEPER))
    running.says("one   | asleep")
    next(process for process in running.family() if process.cmdline()[1:] == SLEEPER[1:]).kill()
    assert running.ends() == 128 + signal.SIGKILL
    running.leaves_nothing()
