"""The checks as a notebook uses them: classes that live in a kernel's ``__main__``."""

from __future__ import annotations

import pytest
from jupyter_client.manager import start_new_kernel

PATIENCE = 60.0

RIGHT = """
import tutorial
from sensor_msgs.msg import Joy
from tutorial.controller import SimpleController
from tutorial.handoff import Latest
from tutorial.checks.tank_controller import drive, aim

def dead_zone(axis):
    return axis if abs(axis) > 0.3 else 0.0

class GentleTank(SimpleController):
    def configure(self, config):
        self.joy = Latest(Joy())
        self.subscription = config.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message):
        self.joy.put(message)

    def initialize(self, io):
        self.track_l, self.track_r = io.body.actuator("TRACK_L"), io.body.actuator("TRACK_R")

    def control(self):
        x, y = map(dead_zone, [*self.joy.get().axes, 0.0, 0.0][:2])
        self.track_l.ctrl = 1.0 * y - 0.5 * x
        self.track_r.ctrl = 1.0 * y + 0.5 * x

    def unconfigure(self):
        self.subscription.destroy()

drive.check(GentleTank)
"""

RAISES = """class Broken(GentleTank):
    def control(self):
        self.track_l.ctrl = self.speed

drive.check(Broken)
"""

LOOPS = """class Loops(GentleTank):
    def on_joy(self, message):
        while True: pass

drive.check(Loops)
"""

WIDGET = """
import ipywidgets
slider = ipywidgets.FloatSlider()

class Slides(GentleTank):
    def control(self):
        self.track_l.ctrl = slider.value

drive.check(Slides)
"""

PROGRAM = """
import asyncio
program = asyncio.get_running_loop()

class Reaches(GentleTank):
    def control(self):
        program.call_soon(print)

drive.check(Reaches)
"""


@pytest.fixture(scope="module")
def run():
    """Run a cell in a kernel, and return what it has printed."""
    manager, client = start_new_kernel(kernel_name="python3")

    def run(source):
        said = []

        def hear(message):
            if message["msg_type"] == "stream":
                said.append(message["content"]["text"])

        reply = client.execute_interactive(source, output_hook=hear, timeout=PATIENCE)
        assert reply["content"]["status"] == "ok", reply["content"]
        return "".join(said)

    yield run
    client.stop_channels()
    manager.shutdown_kernel(now=True)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_answers_of_a_notebook(run):
    said = run(RIGHT)
    assert "✗" not in said
    assert "\nAll right. " in said
    assert run("drive.check(GentleTank)") == said, "the same on every run"

    said = run(RAISES)
    assert "control raised AttributeError: 'Broken' object has no attribute 'speed'" in said
    assert "  in control, line 3: self.track_l.ctrl = self.speed\n" in said
    said = run(LOOPS)
    assert "✗ on_joy does not return\n  in on_joy, line 3: while True: pass\n" in said
    assert "control uses program, an object of the class" in run(PROGRAM)
    said = run(WIDGET)
    assert "control uses slider, an object of the class FloatSlider, that belongs to the notebook" in said, said
