"""What a beginner would mistype, and how a run ends: a clear error, the right status, and never a traceback."""

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

CONTROLLER = """from tutorial.controller import SimpleController
class TankController(SimpleController):
    def control(self):
        1 / 0
"""
FILES = {
    "typo.yaml": "bodies:\n  - name: Tank\n    modle: tank.xml\n",
    "cube.xml": "<mujoco><worldbody><geom type='cube'/></worldbody></mujoco>",
    "cube.yaml": "bodies:\n  - {name: Tank, model: cube.xml}\n",
    "box.xml": "<mujoco><worldbody><body><freejoint/><geom size='.1'/></body></worldbody></mujoco>",
    "box.yaml": "simulator: {}\nbodies:\n  - {name: Box, model: box.xml, controllers: [TankController]}\n",
    "mine.py": CONTROLLER,
}


@pytest.fixture
def here(tmp_path, monkeypatch):
    """The current directory, with files in which something is wrong."""
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize(
    ("command", "status", "said"),
    [
        ("lanch step3", 2, "No such command 'lanch'. Did you mean 'launch'?"),
        ("run", 2, "Missing argument 'PROJECT'"),
        ("run stp3", 1, "Error: there is no project 'stp3'. Did you mean 'step3'?"),
        ("run nowhere/step3.yaml", 1, "there is no project 'nowhere/step3.yaml'"),
        ("launch step33", 1, "there is no launch file 'step33'. Did you mean 'step3'?"),
        ("run step3 --duration -1", 2, "-1.0 is not in the range 0<x<=1000000"),
        ("run step3 --duration nan", 2, "'nan' is not a number of seconds"),
        ("launch step3 --duration inf", 2, "inf is not in the range 0<x<=1000000"),
        ("run step3 --headless --duration 0.1 --report /dev/null/x", 1, "the report '/dev/null/x/tank.json' cannot be"),
        ("run step3 --duration ten", 2, "'ten' is not a valid number of seconds"),
        ("run step3 --durration 1", 2, "No such option '--durration'. Did you mean '--duration'?"),
        ("joy --drive tuor", 1, "there is no drive 'tuor'. Did you mean 'tour'?"),
        ("run step3 --headless --robot nothing.xml", 1, "there is no model 'nothing.xml'"),
        ("run step3 --headless --controller nothing.py", 1, "there is no file 'nothing.py'"),
        ("run step3 --headless --html nowhere/run.html", 1, "there is no folder"),
        ("run step3 --headless --ros-args -r garbage", 1, "Couldn't parse remap rule: '-r garbage'"),
        ("run step3 --headless --ros-args --nonsense", 1, "ROS 2 does not know the arguments ['--nonsense']"),
        ("run step3 --headless --ros-args -r __node:=bad-name", 1, "Couldn't parse remap rule: '-r __node:=bad-name'"),
        ("joy --ros-args -r __ns:=/bad-ns", 1, "Couldn't parse remap rule: '-r __ns:=/bad-ns'"),
        ("topic echo --field . /x", 1, "Invalid field value '.'\n"),
        ("topic echo x//y", 1, "topic name"),
        ("topic echo /later std_msgs/msg/Strin", 1, "The passed message type is invalid\n"),
        ("topic hz a-b", 1, "topic name"),
        ("topic pub a-b std_msgs/msg/String", 1, "topic name"),
        ("topic pub /x std_msgs/msg/String {data:2001-99-99}", 1, "Failed to populate field"),
        ("topic pub /x std_msgs/msg/String data", 1, "The passed value needs to be a dictionary in YAML format\n"),
        ("topic list --ros-args --nonsense", 1, "ROS 2 does not know the arguments ['--nonsense']\n"),
        ("topic ecko /x", 2, "No such command 'ecko'. Did you mean 'echo'?"),
        ("node lst", 2, "No such command 'lst'. Did you mean 'list'?"),
        ("node info", 2, "Missing argument 'NODE_NAME'."),
        ("topic echo", 2, "Missing argument 'TOPIC_NAME'."),
        ("topic pub /x", 2, "Missing argument 'MESSAGE_TYPE'."),
        ("topic pub /x std_msgs/msg/String -r 0", 2, "0.0 is not in the range x>0."),
        ("topic pub /x std_msgs/msg/String -r inf", 2, "'inf' is not a number."),
        ("topic pub /x std_msgs/msg/String -t -1", 2, "-1 is not in the range x>=0."),
        ("topic pub /x std_msgs/msg/String -1 -t 3", 2, "argument -t/--times: not allowed with argument -1/--once"),
        ("topic hz --window 0 /x", 2, "0 is not in the range x>=1."),
        ("topic echo --timeout 0 /x", 2, "0.0 is not in the range 0<x<=1000000."),
        ("topic echo --qos-reliability relable /x", 2, "'relable' is not one of 'reliable', 'best_effort', 'system_"),
        ("bag record", 2, "name topics, or give -a for all of them."),
        ("bag record -a /joy", 2, "name topics, or give -a for all of them."),
        ("bag record -a -s rosbag1", 2, "'rosbag1' is not one of 'mcap', 'sqlite3'"),
        ("bag record -a --max-bag-duration 0", 2, "0.0 is not in the range"),
        ("bag play", 2, "Missing argument 'BAG'"),
        ("bag play a b", 2, "'b' is too much: one bag is played at a time."),
        ("bag play a --rate 0", 2, "0.0 is not in the range"),
        ("bag play a --clock often", 2, "'often' is not a valid number"),
        ("bag info nowhere", 1, "there is no bag"),
        ("chaos --from Tank/joint_state", 1, "the good stream and the faults are both on '/Tank/joint_state'. Have"),
        ("chaos a-b", 1, "topic name"),
        ("chaos -f shufle", 2, "there is no fault 'shufle'. Did you mean 'shuffle'?"),
        ("chaos --fault nan:2", 2, "'2' is no share of the messages for 'nan': give a number from 0 to 1."),
        ("chaos --duration 0", 2, "0.0 is not in the range"),
        ("run typo.yaml", 1, "Error: typo.yaml, line 3: 'modle' is not known here. Did you mean 'model'?"),
        ("run cube.yaml --headless", 1, "does not load. MuJoCo says:"),
        ("run cube.yaml --headless", 1, "cube"),
        ("run box.yaml --headless", 1, "initialize: TutorialError: the body 'Box' has no actuator 'TRACK_L'"),
        *(
            ("run step1 --headless --controller mine.py --report /dev/null/x", 1, said)
            for said in (
                "mine.py, line 4, in control: ZeroDivisionError: division by zero\n",
                "'/dev/null/x/tank.json'",
            )
        ),
    ],
)
def test_a_mistake_is_a_clear_error(tank, here, command, status, said):
    run = tank(command)
    assert (run.status, said in run.stderr) == (status, True), run.said
    assert "is kept" not in run.output


@pytest.mark.parametrize("given", ["1e300", "1000001", "inf", "nan", "-1", ""])
def test_a_number_of_seconds_has_its_bounds(given):
    with pytest.raises(click.BadParameter):
        Seconds(min=0).convert(given, None, None)
    assert Seconds(min=0).convert("1e6", None, None) == 1_000_000


def test_what_is_no_path_is_no_notebook_and_no_folder():
    for command, said in ((check, "there is no file or folder 'xxx"), (progress, "there is no folder 'xxx")):
        with pytest.raises(TutorialError, match=said):
            CliRunner().invoke(command, ["x" * 300], catch_exceptions=False)


def test_a_port_that_is_in_use_is_said(tank):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        run = tank("run step3 --port", port)
    assert run.status == 1
    assert f"the 3D view cannot have port {port}: another program uses it already" in run.stderr


@pytest.mark.process
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


@pytest.mark.parametrize(
    ("command", "status", "once"),
    [
        ("run step2 --duration 300", 130, "look at http://127.0.0.1:"),
        ("joy --drive tour", 0, "scripted drive: tour.yaml\n"),
        ("joy --duration 300", 130, "no gamepad is connected; scripted drive: tour.yaml\n"),
    ],
)
def test_ctrl_c_is_an_interruption_only_of_what_has_a_duration(tank, monkeypatch, command, status, once):
    monkeypatch.setattr("tutorial.commands.joystick.Gamepad.find", lambda: None)
    assert tank(command, once=once).status == status


def test_the_tree_and_the_address_are_printed(tank):
    run = tank("run step3 --duration 0.5")
    assert run.status == 0
    assert run.stdout.startswith("+ Tank\n  - JointStateSubscriber\nlook at http://127.0.0.1:")


def test_a_run_is_kept_as_a_page_also_without_a_view_and_when_it_is_interrupted(tank, tmp_path):
    page = tmp_path / "run.html"
    run = tank("run step2 --headless --html", page, once="+ Simulator")
    assert run.status == 0
    assert 'class="tank-replay"' in page.read_text(encoding="utf-8")


@pytest.mark.process
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
