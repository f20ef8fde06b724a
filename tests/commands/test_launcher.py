"""Launch files without ROS: all processes end together, whatever happens."""

import io
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import nullcontext
from unittest.mock import Mock

import pytest

from tutorial.commands import launcher, tank
from tutorial.commands.launcher import Launcher, load_launch_file
from tutorial.errors import TutorialError

INT, KILL = signal.SIGINT, signal.SIGKILL
FILE = """from launch import LaunchDescription
from launch.actions import ExecuteProcess
def generate_launch_description(): return LaunchDescription([{}])
"""
SLEEP = "import time\nwhile True: time.sleep(0.1)  # in short sleeps: a signal just before a long one would be missed"
SLEEPER = ["python3", "-c", f"print('asleep', flush=True)\n{SLEEP}"]
IGNORE = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); print('stubborn', flush=True)"


@pytest.fixture
def launch_file(tmp_path):
    """Write a launch file with processes, or with commands by name."""

    def write(processes="", **commands):
        path = tmp_path / "test.launch.py"
        named = (f"ExecuteProcess(name={name!r}, cmd={command!r})" for name, command in commands.items())
        path.write_text(FILE.format(processes + ", ".join(named)))
        return path

    return write


class Process(nullcontext):
    """A fake process: its output, its exit status, and the signals that end it."""

    def __init__(self, pid, says="", status=None, heeds=(INT, KILL)):
        super().__init__()
        self.pid, self.stdout, self.status = pid, io.StringIO(says), status
        self.heeds, self.heard, self.over = heeds, [], threading.Event()
        if status is not None:
            self.over.set()

    def wait(self):
        self.over.wait()
        return self.status

    def signal(self, number):
        left = not self.over.is_set()
        if number:
            self.heard.append(number)
        if left and number in self.heeds:
            self.status = -number
            self.over.set()
        return left


KINDS = {
    "sleeper": {"says": "asleep\n"},
    "stubborn": {"says": "stubborn\n", "heeds": [KILL]},
    "failing": {"says": "oh\n", "status": 3},
    "killed": {"status": -9},
    "echo": {"says": f"hello\n{'x' * 30}\n\x1b[2J\u202eb\tc\x85d\n", "status": 0},
    "true": {"status": 0},
}
"""The fake processes, by program."""


class Machine:
    """Starts fake processes."""

    def __init__(self, monkeypatch):
        self.processes, self.given, self.out, self.handle_signals = [], [], io.StringIO(), Mock()
        monkeypatch.setattr(launcher.parent_watch, "start_watched", self.start)
        monkeypatch.setattr(launcher.parent_watch, "signal_group", lambda pid, n: self.processes[pid].signal(n))
        monkeypatch.setattr(launcher, "handle_signals", self.handle_signals)

    def start(self, words, environment, folder):
        if folder is not None:
            raise eval(folder)
        self.processes.append(Process(len(self.processes), **KINDS[words[-1]]))
        self.given.append(environment)
        return self.processes[-1]

    def run(self, path, ask=False, **environment):
        """Run a launch file, ask it to stop once each process has printed something, and return the exit status."""
        self.launcher = Launcher(load_launch_file(path), environment, self.out)

        def look(_):
            if ask and len(self.lines) >= len(self.processes):
                self.handle_signals.call_args.args[0]()

        return self.launcher.run(look)

    @property
    def lines(self):
        return [line.partition(" ")[2] for line in self.out.getvalue().splitlines()]

    @property
    def heard(self):
        return [process.heard for process in self.processes]


@pytest.fixture
def machine(monkeypatch):
    return Machine(monkeypatch)


def test_each_line_names_its_process_and_is_escaped(machine, launch_file, monkeypatch):
    monkeypatch.setenv("LANG", "C")
    monkeypatch.setattr(launcher.shutil, "which", lambda word, path: None)
    more = ("", "additional_env={'B': '2'}", "env={'PATH': '/nowhere'}")
    path = launch_file(", ".join(f"ExecuteProcess(cmd=['echo'], {each})" for each in more))
    assert machine.run(path, A="1", B="1") == 0
    texts = ("hello", "x" * 30, "\\x1b[2J\\u202eb\tc\\x85d")
    assert sorted(machine.lines) == sorted(
        f"{name} | {text}" for name in ("echo  ", "echo-2", "echo-3") for text in texts
    )
    wanted = [("1", "1", "C"), ("1", "2", "C"), ("1", "1", None)]
    assert [tuple(map(each.get, ("A", "B", "LANG"))) for each in machine.given] == wanted
    assert machine.given[2]["PATH"].endswith(os.pathsep + "/nowhere")
    assert not machine.launcher.interrupted


@pytest.mark.parametrize(("program", "status", "left"), [("failing", 3, []), ("killed", 137, [INT])])
def test_when_one_fails_the_rest_stop_and_its_status_counts(machine, launch_file, program, status, left):
    assert machine.run(launch_file(sleeper=["sleeper"], **{program: [program]})) == status
    said = [line for line in machine.lines if "failed with" in line]
    assert said == [f"{program:7} | failed with exit status {status}; stopping the other processes"]
    assert machine.heard == [[INT], left]  # the remaining group of the killed process


def test_when_stopping_it_kills_processes_that_do_not_end(machine, launch_file, monkeypatch):
    monkeypatch.setattr(launcher, "TIMEOUT", 0.2)
    assert machine.run(launch_file(sleeper=["sleeper"], stubborn=["stubborn"]), ask=True) == 0
    assert machine.launcher.interrupted
    assert machine.lines[-1] == "stubborn | did not stop within 0.2 s; killing it"
    assert machine.heard[0] == [INT]
    assert machine.heard[1][:2] == [INT, KILL]


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ('cwd=\'FileNotFoundError(2, "No such file", "/nowhere")\'', "[Errno 2] No such file: '/nowhere'"),
        ("cwd='ValueError(\"embedded null byte\")'", "embedded null byte"),
        ("additional_env=5", "'int' object is not a mapping"),
    ],
)
def test_started_processes_stop_if_a_later_one_cannot_start(machine, launch_file, more, said):
    path = launch_file(f"ExecuteProcess(cmd=['sleeper']), ExecuteProcess(name='other', cmd=['true'], {more})")
    with pytest.raises(TutorialError) as info:
        machine.run(path)
    assert str(info.value) == f"other could not be started: {said}"
    assert (machine.heard, "failed" in machine.out.getvalue()) == ([[INT]], False)


def test_all_stop_when_the_output_is_closed(machine, launch_file, monkeypatch):
    monkeypatch.setattr(machine.out, "write", Mock(side_effect=BrokenPipeError))
    assert machine.run(launch_file(sleeper=["sleeper"])) == 0
    assert machine.heard == [[INT]]


DEFINED = "def generate_launch_description()"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("from launch.substitutions import X", "Run it with a real ROS 2: ros2 launch"),
        ("x = 1", "has no function generate_launch_description()"),
        (f"\n{DEFINED}: 1 / 0", ".py, line 2, in generate_launch_description: ZeroDivisionError: division by zero"),
        ("raise SystemExit(0)", "test.launch.py, line 1: SystemExit: 0"),
        (FILE.format(""), "that returns a LaunchDescription with a process"),
        (FILE.format("ExecuteProcess(cmd=[])"), "its cmd is []. Give a list of words, such as cmd=['tank', 'joy']"),
        (FILE.format("ExecuteProcess(cmd='tank joy')"), "its cmd is 'tank joy'. Give a list of words"),
        (FILE.format("ExecuteProcess(cmd=[['tank']] * 10_000)"), "its cmd is [['tank'], ['tank']"),
    ],
)
def test_a_bad_launch_file_is_reported_before_any_start(launch_file, text, said):
    path = launch_file()
    path.write_text(text)
    with pytest.raises(TutorialError) as info:
        load_launch_file(path)
    assert str(info.value).startswith(str(path))
    assert said in str(info.value)
    assert len(str(info.value)) < 2 * len(str(path)) + 300


@pytest.mark.process
def test_an_unknown_command_stops_real_processes(program, launch_file):
    running = program("launch", launch_file(sleeper=SLEEPER, missing=["no-such-command"]))
    assert running.ends() == 127
    assert "missing | no-such-command could not be started: No such file or directory\n" in running.output
    running.leaves_nothing()


@pytest.mark.process
def test_no_process_outlives_a_killed_launcher(program, launch_file):
    running = program("launch", launch_file(one=SLEEPER, other=["python3", "-c", f"{IGNORE}\n{SLEEP}"]))
    running.says("asleep")
    running.says("stubborn")
    running.process.kill()
    running.leaves_nothing()


def test_log_lines_appear_above_the_progress_bar(monkeypatch, launch_file):
    shown = io.StringIO()
    shown.isatty = lambda: True
    for stream in ("stdout", "stderr"):
        monkeypatch.setattr(sys, stream, shown)

    def run(launcher, progress):
        for second in (1, 2, 3):
            progress(second)
            launcher._say("chatty", "chat")

    monkeypatch.setattr(Launcher, "run", run)
    tank._launch(str(launch_file(chatty=["true"])), 2.0, False, None)
    lines = [line.rpartition("\r")[2] for line in shown.getvalue().split("\n")]
    assert ["%" in line for line in lines if "chat" in line] == [False] * 3
    assert f"100% |{'=' * 40}| 2 of 2 s" in lines[-2]


HELD_UP = """import os, runpy, subprocess, sys
turn = int(sys.argv[1])
class Popen(subprocess.Popen):
    def __init__(self, *arguments, **options):
        print("not yet", flush=True)
        os.read(turn, 1)
        super().__init__(*arguments, **options)
        os.read(turn, 1)
subprocess.Popen = Popen
sys.argv[:2] = []
runpy.run_path(sys.argv[0], run_name="__main__")
"""
COUNTS = """import signal, time
asked = []
signal.signal(signal.SIGINT, lambda *_: asked.append(1))
print("up", flush=True)
while not asked: time.sleep(0.01)
time.sleep(0.2)
print(len(asked))
"""


@pytest.mark.process
def test_ctrl_c_while_a_command_starts_gives_no_traceback():
    watch = launcher.parent_watch
    for moment in range(20):
        with watch.start_watched([watch.OWN, "--version"], os.environ) as process:
            time.sleep(0.005 * moment)
            watch.signal_group(process.pid, INT)
            assert "Traceback" not in process.stdout.read()


@pytest.mark.process
@pytest.mark.parametrize(("when", "status", "last"), [("not yet\n", 128 + INT, "not yet\n"), ("up\n", 0, "1\n")])
def test_a_starting_command_is_asked_to_stop_only_once(when, status, last):
    turn, give = os.pipe()
    words = [sys.executable, "-c", HELD_UP, str(turn), launcher.parent_watch.__file__, sys.executable, "-c", COUNTS]
    pipe = subprocess.PIPE
    with subprocess.Popen(
        words, stdin=pipe, stdout=pipe, pass_fds=(turn,), start_new_session=True, text=True
    ) as process:
        while (line := process.stdout.readline()) != when:
            os.write(give, b"..")
        os.killpg(process.pid, INT)
        os.write(give, b"..")
        assert (line + process.stdout.read()).endswith(last)
    os.close(turn)
    os.close(give)
    assert process.returncode == status
