"""A beginner's mistakes, and the end of a run: a clear error, the right status, and never a traceback."""

import signal

import pytest

from tutorial.body import Body
from tutorial.description.urdf import robot_description
from tutorial.system.paths import find_model
from tutorial.world import Placement

CONTROLLER = """from tutorial.controller import SimpleController
class TankController(SimpleController):
    def control(self):
        1 / 0
"""


@pytest.mark.parametrize(
    ("command", "status", "said"),
    [
        ("lanch step3", 2, "No such command 'lanch'. Did you mean 'launch'?"),
        ("run stp3", 1, "Error: there is no project 'stp3'. Did you mean 'step3'?"),
        ("run step3 --duration -1", 2, "-1.0 is not in the range 0<x<=1000000"),
        ("run step3 --duration nan", 2, "'nan' is not a number."),
        ("run step3 --headless --duration 0.1 --report /dev/null/x", 1, "the report /dev/null/x/tank.json cannot be"),
        ("run step3 --durration 1", 2, "No such option '--durration'. Did you mean '--duration'?"),
        ("run step3 --headless --ros-args -r garbage", 1, "Couldn't parse remap rule: '-r garbage'"),
        ("topic echo x//y", 1, "topic name"),
        ("topic pub a-b std_msgs/msg/String", 1, "topic name"),
        ("topic pub /x std_msgs/msg/String data", 1, "The passed value needs to be a dictionary in YAML format\n"),
        ("topic list --ros-args --nonsense", 1, "Error: ROS 2 does not recognize the arguments ['--nonsense']\n"),
        (
            "node list --ros-args -r __ns:=",
            1,
            "Error: ROS 2 reports: failed to initialize rcl: Couldn't parse remap rule",
        ),
        ("urdf tnak", 1, "there is no model 'tnak'. Did you mean 'tank'?"),
        ("run step3 --robot tnak", 1, "there is no model 'tnak'. Did you mean 'tank'?"),
        ("urdf arm.urdf.xacro", 1, "the model 'arm.urdf.xacro' is a xacro file."),
        ("run step3 --robot arm.urdf.xacro", 1, "the model 'arm.urdf.xacro' is a xacro file."),
        ("urdf mine.py", 1, "'mine.py' is not a model: its name does not end in '.xml'."),
        ("check .", 1, "Error: there are no notebooks in ."),
        ("bag record", 2, "name the topics, or give -a for all topics."),
        ("bag play a b", 2, "'b' is unexpected: give one bag"),
        ("bag play a --clock 1e308", 2, "1e+308 is not in the range 0<x<=1000."),
        ("chaos --from a-b", 1, "topic name"),
        ("chaos -f shufle", 2, "there is no fault 'shufle'. Did you mean 'shuffle'?"),
        ("race mne.py", 2, "File 'mne.py' does not exist."),
        ("race mine.py --layout bnd", 1, "Error: there is no layout 'bnd'. Did you mean 'bend'?"),
        ("run step1 --headless --controller mine.py", 1, ": mine.py, line 4, in control: ZeroDivisionError: "),
    ],
)
def test_a_mistake_is_a_clear_error(tank, tmp_path, monkeypatch, command, status, said):
    (tmp_path / "mine.py").write_text(CONTROLLER)
    (tmp_path / "arm.urdf.xacro").write_text('<robot name="arm"/>')
    monkeypatch.chdir(tmp_path)
    run = tank(command)
    assert (run.status, said in run.stderr) == (status, True), run.output
    assert "the replay is in" not in run.output


SLOW = """import time
print('loading', flush=True)
try:
    time.sleep(300)
except KeyboardInterrupt:
    raise ImportError('initialization failed')
"""


@pytest.mark.process
def test_ctrl_c_while_loading_ends_the_program(program, tmp_path):
    """A module may turn a KeyboardInterrupt during its import into its own error, as numpy does."""
    path = tmp_path / "slow.launch.py"
    path.write_text(SLOW)
    running = program("launch", path)
    running.says("loading")
    running.asks_to_stop()
    assert running.ends() == -signal.SIGINT
    assert running.output == "loading\n"


@pytest.mark.parametrize(
    ("command", "status", "once"),
    [
        ("run step3 --duration 300", 130, "+ Tank\n  - JointStateSubscriber\n3D view: http://127.0.0.1:"),
        ("joy --drive tour", 0, "scripted drive: tour.yaml\n"),
        ("joy --duration 300", 130, "no gamepad is connected; scripted drive: tour.yaml\n"),
    ],
)
def test_ctrl_c_interrupts_only_a_run_with_a_duration(tank, monkeypatch, command, status, once):
    monkeypatch.setattr("tutorial.commands.joystick.Gamepad.find", lambda: None)
    assert tank(command, once=once).status == status


def test_an_interrupted_headless_run_is_saved_as_a_page(tank, tmp_path):
    page = tmp_path / "run.html"
    run = tank("run step2 --headless --html", page, once="+ Simulator")
    assert run.status == 0
    assert 'class="tank-replay"' in page.read_text(encoding="utf-8")


@pytest.mark.parametrize("given", ["Crane", find_model("crane")])
def test_urdf_prints_what_the_controller_publishes(tank, given):
    assert tank("urdf", given).stdout == robot_description(Body.displayed(Placement("Crane", find_model("crane"))))


def test_run_and_urdf_take_a_urdf(tank, tmp_path, monkeypatch):
    (tmp_path / "arm.urdf").write_text(
        '<robot name="a"><link name="HAND"><visual>BOX</visual></link></robot>'.replace(
            "BOX", '<geometry><box size="1 1 1"/></geometry>'
        )
    )
    monkeypatch.chdir(tmp_path)
    described = tank("urdf arm.urdf")
    assert '<link name="HAND">\n    <visual>' in described.stdout
    assert tank("run step3 --headless --duration 0.1 --robot arm.urdf").stdout.startswith("+ Arm\n")
