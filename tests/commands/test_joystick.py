"""Drive files, errors in them, and the joystick's lifetime."""

import re
import sys
import threading

import pytest
from packages import run
from programs import TIMEOUT
from sensor_msgs.msg import Joy

from tutorial.commands.joystick import ScriptedDrive, publish_joystick
from tutorial.errors import TutorialError
from tutorial.ros.node_thread import NodeThread
from tutorial.system.paths import HOME, find_drive


@pytest.fixture
def drive(tmp_path):
    def drive(text):
        (tmp_path / "drive.yaml").write_text(text)
        return ScriptedDrive(tmp_path / "drive.yaml")

    return drive


def test_axes_are_held_until_the_next_entry(drive):
    held = drive("drive:\n- {time: 1, axes: [0, 0.5]}\n- {time: 2.5, axes: [1]}")
    read = [held.read(seconds) for seconds in (0.0, 1.0, 2.4, 99.0)]
    assert read == [([0.0] * 6, []), ([0.0, 0.5], []), ([0.0, 0.5], []), ([1.0], [])]


def test_a_drive_may_repeat(drive):
    moments = "{time: 0, axes: [0.1]}", "{time: 1, axes: [0.2]}", "{time: 2, axes: []}"
    repeated = drive(f"repeat: true\ndrive: [{', '.join(moments)}]")
    assert [repeated.read(seconds)[0] for seconds in (0.5, 1.5, 2.5, 3.5, 200.5)] == [[0.1], [0.2], [0.1], [0.2], [0.1]]


def test_it_ends_with_its_simulation_although_other_nodes_listen(domain):
    with NodeThread("joy") as joy, NodeThread("simulation") as simulation, NodeThread("bystander") as bystander:
        bystander.node.create_subscription(Joy, "joy", lambda _: None, 1)
        subscription = simulation.node.create_subscription(Joy, "joy", lambda _: None, 1)

        def leave(_seconds):
            (publisher,) = (each for each in joy.node.publishers if each.topic_name == "/joy")
            if publisher.get_subscription_count() == 2:
                simulation.node.destroy_subscription(subscription)

        stop = threading.Event()
        drive = ScriptedDrive(find_drive("tour"))
        assert publish_joystick(joy.node, drive, 0.1, 2 * TIMEOUT, stop, leave) < TIMEOUT


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("drive:\n- {time: 1, axis: [0]}", "line 2: unknown key 'axis'. Did you mean 'axes'?"),
        ("drives: []", "line 1: unknown key 'drives'. Did you mean 'drive'?"),
        ("drive:\n- {time: 0, axes: [2]}", "line 2: drive[0].axes[0]: expected a number <= 1."),
        ("drive:\n- {time: 1, axes: []}\n- {time: 1, axes: []}", "line 3: 1.0 is not later than 1.0. Put the times"),
    ],
)
def test_a_bad_drive_is_reported_with_line_and_fix(drive, tmp_path, text, said):
    with pytest.raises(TutorialError, match=re.escape(f"{tmp_path / 'drive.yaml'}, {said}")):
        drive(text)


VIRTUAL_GAMEPAD = """
import ctypes
import tutorial
from tutorial.commands.joystick import Gamepad

assert Gamepad.find() is None
path = next(line.split()[-1] for line in open("/proc/self/maps") if "libSDL2-2" in line)
sdl = ctypes.CDLL(path)
sdl.SDL_JoystickOpen.restype = ctypes.c_void_p
index = sdl.SDL_JoystickAttachVirtual(1, 6, 15, 0)  # a game controller with six axes and fifteen buttons
stick = ctypes.c_void_p(sdl.SDL_JoystickOpen(index))
gamepad = Gamepad.find()
for axis, value in enumerate((-32768, -32768, 16384, 32767, 32767)):
    sdl.SDL_JoystickSetVirtualAxis(stick, axis, ctypes.c_int16(value))
sdl.SDL_JoystickSetVirtualButton(stick, 0, ctypes.c_uint8(1))
axes, buttons = gamepad.read(0.0)
print([round(axis, 2) for axis in axes], buttons[:2])
"""


@pytest.mark.process
@pytest.mark.skipif(sys.platform != "linux", reason="SDL's library is looked up in /proc")
def test_left_and_forward_are_positive():
    pytest.importorskip("pygame", reason="the extra 'gamepad' is not installed")
    said = run("-W", "error", "-c", VIRTUAL_GAMEPAD, cwd=HOME)
    assert said.splitlines()[-1] == "[1.0, 1.0, -0.5, -1.0, -1.0, 0.0] [1, 0]"
