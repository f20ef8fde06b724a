"""Launch files without ROS: processes that end together, whatever happens."""

from __future__ import annotations

import asyncio
import io
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from programs import PATIENCE, TANK

from tutorial.commands.launcher import Launcher, load_launch_file
from tutorial.errors import TutorialError
from tutorial.paths import find_launch_file

SLEEP = "import time\nwhile True: time.sleep(0.1)  # not in one go: a signal that comes just before would not be heard"
SLEEPER = ["python3", "-c", f"print('asleep', flush=True)\n{SLEEP}"]
STUBBORN = [
    "python3",
    "-c",
    f"import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); print('stubborn', flush=True)\n{SLEEP}",
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


def test_what_a_process_prints_reaches_no_terminal_raw(launch_file):
    printed = "print('\\x1b[2J\\u202eb\\tc\\x85d', flush=True)"
    run = subprocess.run(
        [TANK, "launch", str(launch_file(one=["python3", "-c", printed]))],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert run.returncode == 0
    assert run.stdout.endswith("one | \\x1b[2J\\u202eb\tc\\x85d\n")


@pytest.mark.parametrize(
    ("step", "names"),
    [
        ("step1", ["joystick", "simulation"]),
        ("step2", ["joystick", "simulation"]),
        ("step3", ["joystick", "simulation", "viewer"]),
        ("step7", ["joystick", "simulation", "viewer"]),
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
        ("from launch.substitutions import X", "Run it with a real ROS 2: ros2 launch"),
        ("x = 1", "has no function generate_launch_description()"),
        (
            "\ndef generate_launch_description(): 1 / 0",
            "bad.launch.py, line 2, in generate_launch_description: ZeroDivisionError: division by zero",
        ),
        ("raise SystemExit(0)", "bad.launch.py, line 1: SystemExit: 0"),
        ("def generate_launch_description(", "SyntaxError"),
        ("def generate_launch_description(): return {}['key']", "KeyError: 'key'"),
        ("def generate_launch_description(): pass", "returned no LaunchDescription"),
        (
            "import launch\ndef generate_launch_description(): return launch.LaunchDescription([])",
            "describes no process",
        ),
    ],
)
def test_a_bad_launch_file_says_what_is_wrong(tmp_path, text, said):
    path = tmp_path / "bad.launch.py"
    path.write_text(text)
    with pytest.raises(TutorialError) as info:
        load_launch_file(path)
    assert str(path) in str(info.value)
    assert said in str(info.value)


PROCESSES = """
from launch import LaunchDescription
from launch.actions import ExecuteProcess
def generate_launch_description():
    return LaunchDescription([{}])
"""


@pytest.mark.parametrize(
    ("process", "said"),
    [
        (
            "ExecuteProcess(cmd=[])",
            "its cmd is empty. Give the program and its arguments, such as cmd=['tank', 'joy'].",
        ),
        ("ExecuteProcess(cmd=[''])", "its cmd is empty. Give"),
        ("ExecuteProcess(cmd='tank joy')", "its cmd is 'tank joy'. Give a list of words"),
        ("ExecuteProcess(cmd=None)", "its cmd is None. Give a list of words"),
        ("ExecuteProcess(cmd=[['tank']] * 10_000)", "its cmd is [['tank'], ['tank']"),
        ("ExecuteProcess(cmd=['true'], name='n' * 300)", "its name is 'nnn"),
        (r"ExecuteProcess(cmd=['true'], name='\x1b[2J')", r"its name is '\x1b[2J'. Give a text of 60 letters"),
        ("*[ExecuteProcess(cmd=['true'])] * 2000", "describes 2,000 processes. Start 50 at most at a time."),
    ],
)
def test_what_cannot_be_started_is_said_before_anything_is(tmp_path, process, said):
    path = tmp_path / "bad.launch.py"
    path.write_text(PROCESSES.format(process))
    with pytest.raises(TutorialError) as info:
        load_launch_file(path)
    assert str(info.value).startswith(f"{path} ")
    assert said in str(info.value)
    assert len(str(info.value)) < len(str(path)) + 250


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (r"cmd=['true', 'a\0b']", "one could not be started: embedded null byte"),
        (r"cmd=['true'], cwd='a\0b'", "one could not be started: embedded null byte"),
        ("cmd=['true'], env={'A': 1}", "one could not be started: expected str"),
        ("cmd=['true'], additional_env=5", "one could not be started: 'int' object is not a mapping"),
    ],
)
def test_what_no_program_can_be_given_is_said(tmp_path, monkeypatch, more, said):
    monkeypatch.setattr("tutorial.commands.launcher.heed", lambda *_, **__: None)  # these signals are pytest's here
    path = tmp_path / "bad.launch.py"
    path.write_text(PROCESSES.format(f"ExecuteProcess(name='one', {more})"))
    launcher = Launcher(load_launch_file(path), {}, io.StringIO())
    with pytest.raises(TutorialError, match=f"^{said}"):
        asyncio.run(launcher.run())


def test_lines_have_the_process_in_front(program, launch_file):
    running = program("launch", launch_file(one=["echo", "hello"], another=["echo", "world"]))
    assert running.ends() == 0
    assert "one     | hello" in running.output
    assert "another | world" in running.output


def test_processes_without_a_name_are_called_after_their_program(program, tmp_path):
    path = tmp_path / "test.launch.py"
    path.write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import ExecuteProcess\n"
        "def generate_launch_description():\n"
        "    return LaunchDescription([ExecuteProcess(cmd=['echo', word]) for word in ('hello', 'world')])\n"
    )
    running = program("launch", path)
    assert running.ends() == 0
    assert "echo   | hello" in running.output
    assert "echo-2 | world" in running.output


def test_what_was_started_is_stopped_when_another_cannot_be(program, tmp_path):
    path = tmp_path / "test.launch.py"
    path.write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import ExecuteProcess\n"
        "def generate_launch_description():\n"
        f"    sleeper = ExecuteProcess(name='one', cmd={SLEEPER!r})\n"
        "    return LaunchDescription([sleeper, ExecuteProcess(name='other', cmd=['true'], cwd='/nowhere')])\n"
    )
    running = program("launch", path)
    assert running.ends() == 1
    assert not running.family()
    assert "Error: other could not be started: No such file or directory: '/nowhere'" in running.output


def test_when_nobody_reads_any_more_all_are_stopped(launch_file):
    chatty = ["python3", "-c", "import time\nwhile True: print('chat', flush=True); time.sleep(0.01)"]
    path = launch_file(sleeper=SLEEPER, chatty=chatty)
    with subprocess.Popen([TANK, "launch", path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stdout.readline()
        running.stdout.close()
        complaints = running.stderr.read()
    assert "Traceback" not in complaints


def test_a_command_that_is_asked_to_stop_before_it_runs_is_told(tmp_path):
    """The lifeline is asked while it starts the command, which must not miss it."""
    ready = tmp_path / "ready"
    ready_then_sleep = f"import pathlib; pathlib.Path({str(ready)!r}).touch()\n{SLEEP}"
    script = (
        "import os, signal, subprocess, sys\n"
        "from tutorial.commands import lifeline\n"
        "class Slow(subprocess.Popen):\n"
        "    def __init__(self, command):\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "        super().__init__(command)\n"
        f"        while not os.path.exists({str(ready)!r}): pass\n"
        "subprocess.Popen = Slow\n"
        f"sys.argv[1:] = ['0', sys.executable, '-c', {ready_then_sleep!r}]\n"
        "sys.exit(lifeline.main())\n"
    )
    command = [sys.executable, "-c", script]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.DEVNULL, start_new_session=True) as running:
        assert running.wait(PATIENCE) == 128 + signal.SIGINT


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


@pytest.mark.parametrize("second", [signal.SIGINT, signal.SIGTERM])
def test_asked_twice_it_waits_for_nobody_and_leaves_nobody(program, launch_file, second):
    refusing = (
        "import signal; signal.signal(signal.SIGINT, lambda *_: print('no', flush=True)); print('up', flush=True)"
    )
    running = program("launch", launch_file(one=["python3", "-c", f"{refusing}\n{SLEEP}"]))
    running.says("up")
    running.asks_to_stop()
    running.says("no\n")
    running.process.send_signal(second)
    assert running.ends() == 128 + second
    assert "did not stop within" not in running.output
    running.leaves_nothing()


def test_a_terminal_that_closes_asks_as_often_as_it_likes(program, launch_file, tmp_path):
    more = tmp_path / "more"
    tidying = (
        "import os, signal, sys\n"
        f"def end(*_):\n    print('tidying', flush=True)\n    while not os.path.exists({str(more)!r}): pass\n"
        "    print('tidy', flush=True)\n    sys.exit()\n"
        "signal.signal(signal.SIGINT, end); print('up', flush=True)"
    )
    running = program("launch", launch_file(one=["python3", "-c", f"{tidying}\n{SLEEP}"]))
    running.says("up")
    for _ in range(2):
        running.process.send_signal(signal.SIGHUP)
        running.says("tidying")
    more.touch()
    assert running.ends() == 0
    assert "tidy\n" in running.output
    running.leaves_nothing()


def test_nothing_outlives_a_launcher_that_is_killed(program, launch_file):
    running = program("launch", launch_file(one=SLEEPER, other=STUBBORN))
    running.says("asleep")
    running.says("stubborn")
    running.process.kill()
    running.leaves_nothing()


def test_who_has_lost_its_lifeline_is_stopped_with_the_others_at_once(program, launch_file):
    running = program("launch", launch_file(one=SLEEPER, other=SLEEPER))
    running.says("one   | asleep")
    running.says("other | asleep")
    next(process for process in running.family() if Path(process.cmdline()[3]).name == "lifeline.py").kill()
    running.says("failed with exit status 137; the others are stopped")
    assert running.ends() == 128 + signal.SIGKILL
    running.leaves_nothing()


def test_a_process_that_is_killed_has_failed(program, launch_file):
    running = program("launch", launch_file(one=SLEEPER, other=SLEEPER))
    running.says("one   | asleep")
    next(process for process in running.family() if process.cmdline()[1:] == SLEEPER[1:]).kill()
    assert running.ends() == 128 + signal.SIGKILL
    running.leaves_nothing()
