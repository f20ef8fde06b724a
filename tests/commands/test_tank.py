"""What a beginner would mistype: a clear error, a status that is not 0, and never a traceback."""

from __future__ import annotations

import contextlib
import os
import pty
import signal
import socket
import subprocess
import termios

import click
import pytest
from click.testing import CliRunner
from programs import TANK

from tutorial.commands.check import check
from tutorial.commands.options import Seconds
from tutorial.commands.progress import progress
from tutorial.errors import TutorialError


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("lanch step3", "No such command 'lanch'. Did you mean 'launch'?"),
        ("run", "Missing argument 'PROJECT'"),
        ("run stp3", "there is no project 'stp3'. Did you mean 'step3'?"),
        ("run nowhere/step3.yaml", "there is no project 'nowhere/step3.yaml'"),
        ("launch step33", "there is no launch file 'step33'. Did you mean 'step3'?"),
        ("run step3 --duration -1", "-1.0 is not in the range 0<x<=1000000"),
        ("run step3 --duration nan", "'nan' is not a number of seconds"),
        ("launch step3 --duration inf", "inf is not in the range 0<x<=1000000"),
        ("run step3 --headless --duration 0.1 --report /dev/null/x", "the report '/dev/null/x/tank.json' cannot be"),
        ("run step3 --duration ten", "'ten' is not a valid number of seconds"),
        ("run step3 --durration 1", "No such option '--durration'. Did you mean '--duration'?"),
        ("joy --drive tuor", "there is no drive 'tuor'. Did you mean 'tour'?"),
        ("run step3 --headless --robot nothing.xml", "there is no model 'nothing.xml'"),
        ("run step3 --headless --controller nothing.py", "there is no file 'nothing.py'"),
        ("run step3 --headless --ros-args -r garbage", "Couldn't parse remap rule: '-r garbage'"),
        ("run step3 --headless --ros-args --nonsense", "ROS 2 does not know the arguments ['--nonsense']"),
        ("run step3 --headless --ros-args -r __node:=bad-name", "Couldn't parse remap rule: '-r __node:=bad-name'"),
        ("joy --ros-args -r __ns:=/bad-ns", "Couldn't parse remap rule: '-r __ns:=/bad-ns'"),
    ],
)
def test_a_mistake_is_a_clear_error(program, command, said):
    running = program(*command.split())
    assert running.ends() not in (0, None)
    assert said in running.output
    assert "Traceback" not in running.output


@pytest.mark.parametrize("given", ["1e300", "1000001", "inf", "nan", "-1", ""])
def test_a_number_of_seconds_has_its_bounds(given):
    with pytest.raises(click.BadParameter):
        Seconds(min=0).convert(given, None, None)
    assert Seconds(min=0).convert("1e6", None, None) == 1_000_000


def test_what_is_no_path_is_no_notebook_and_no_folder():
    runner = CliRunner()
    for command, said in ((check, "there is no file or folder 'xxx"), (progress, "there is no folder 'xxx")):
        with pytest.raises(TutorialError, match=said):
            runner.invoke(command, ["x" * 300], catch_exceptions=False)


def test_a_malformed_project_is_named_with_its_line(program, tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("bodies:\n  - name: Tank\n    modle: tank.xml\n")
    running = program("run", path)
    assert running.ends() == 1
    assert f"Error: {path}, line 3: 'modle' is not known here. Did you mean 'model'?" in running.output


def test_a_model_that_does_not_load_is_explained_in_mujocos_words(program, tmp_path):
    (tmp_path / "tank.xml").write_text("<mujoco><worldbody><geom type='cube'/></worldbody></mujoco>")
    path = tmp_path / "mine.yaml"
    path.write_text("bodies:\n  - {name: Tank, model: tank.xml}\n")
    running = program("run", path, "--headless")
    assert running.ends() == 1
    assert "does not load. MuJoCo says:" in running.output
    assert "cube" in running.output
    assert "Traceback" not in running.output


def test_a_port_that_is_in_use_is_said(program):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        running = program("run", "step3", "--port", port)
        assert running.ends() == 1
    assert f"the 3D view cannot have port {port}: another program uses it already" in running.output


def test_a_controller_that_raises_ends_the_run_and_says_where(program, tmp_path):
    model = tmp_path / "box.xml"
    model.write_text("<mujoco><worldbody><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>")
    path = tmp_path / "mine.yaml"
    path.write_text("simulator: {}\nbodies:\n  - {name: Box, model: box.xml, controllers: [TankController]}\n")
    running = program("run", path, "--headless")
    assert running.ends() == 1
    assert "initialize: TutorialError: the body 'Box' has no actuator 'TRACK_L'" in (running.output)


def test_a_report_that_cannot_be_written_does_not_hide_why_the_run_ended(program, tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(
        "from tutorial.controller import SimpleController\n"
        "class TankController(SimpleController):\n    def control(self):\n        1 / 0\n"
    )
    running = program("run", "step1", "--headless", "--controller", path, "--report", "/dev/null/x")
    assert running.ends() == 1
    assert "mine.py, line 4, in control: ZeroDivisionError: division by zero\n" in running.output
    assert "the report '/dev/null/x/tank.json' cannot be written" in running.output


def test_ctrl_c_while_the_program_is_loading_just_ends_it(program, tmp_path):
    """A module that is being imported may make an error of its own of a KeyboardInterrupt, as numpy does."""
    path = tmp_path / "slow.launch.py"
    path.write_text(
        "import time\n"
        "print('loading', flush=True)\n"
        "try:\n    time.sleep(300)\n"
        "except KeyboardInterrupt:\n    raise ImportError('initialization failed')\n"
    )
    running = program("launch", path)
    running.says("loading")
    running.asks_to_stop()
    assert running.ends() == -signal.SIGINT
    assert running.output == "loading\n"


def test_ctrl_c_is_how_a_run_without_a_duration_ends(program):
    running = program("run", "step2", "--headless")
    running.says("+ Simulator")
    running.asks_to_stop()
    assert running.ends() == 0
    running.leaves_nothing()


def test_ctrl_c_before_the_duration_is_over_is_an_interruption(program):
    running = program("run", "step2", "--duration", 300)
    running.says("look at http://127.0.0.1:")
    running.asks_to_stop()
    assert running.ends() == 130
    running.leaves_nothing()


def test_on_a_terminal_lines_stand_above_the_progress_bar(domain, tmp_path):
    path = tmp_path / "chatty.launch.py"
    path.write_text(
        "from launch import LaunchDescription\n"
        "from launch.actions import ExecuteProcess\n"
        "def generate_launch_description():\n"
        "    chat = 'for i in 1 2 3 4 5; do echo chat $i; sleep 0.2; done'\n"
        "    return LaunchDescription([ExecuteProcess(name='chatty', cmd=['sh', '-c', chat])])\n"
    )
    terminal, other_end = pty.openpty()
    termios.tcsetwinsize(other_end, (30, 100))
    with subprocess.Popen([TANK, "launch", path, "--duration", "2"], stdout=other_end, stderr=other_end):
        os.close(other_end)
        shown = b""
        with contextlib.suppress(OSError):  # Linux's way to say that the other end is closed
            while piece := os.read(terminal, 4096):
                shown += piece
    os.close(terminal)
    assert shown.count(b"chat ") == 5
    lines = [line.rstrip(b"\r").rsplit(b"\r", 1)[-1] for line in shown.split(b"\n")]
    assert not [line for line in lines if b"chat " in line and b"%" in line]
    assert b"%" in lines[-2]


def test_the_tree_and_the_address_are_printed(program):
    running = program("run", "step3", "--duration", 0.5)
    assert running.ends() == 0
    assert "+ Tank\n  - JointStateSubscriber\n" in running.output
    assert "look at http://127.0.0.1:" in running.output


def test_a_run_is_kept_as_a_page_also_without_a_view_and_when_it_is_interrupted(program, tmp_path):
    page = tmp_path / "run.html"
    running = program("run", "step2", "--headless", "--html", page)
    running.says("Simulator")
    running.asks_to_stop()
    assert running.ends() == 0
    assert f"the run is kept in {page}" in running.output
    assert 'class="tank-replay"' in page.read_text(encoding="utf-8")


def test_a_page_that_cannot_be_written_is_said_before_the_run(program, tmp_path):
    running = program("run", "step3", "--headless", "--html", tmp_path / "nowhere" / "run.html")
    assert running.ends() == 1
    assert "there is no folder" in running.output
    assert "is kept" not in running.output
