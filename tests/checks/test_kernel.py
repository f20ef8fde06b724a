"""The checks as a notebook uses them: classes that live in a kernel's ``__main__``, and cells that are awaited."""

from __future__ import annotations

import pytest
from kernels import kernel
from programs import until

pytestmark = pytest.mark.process

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
        self.node = config.node
        self.joy = Latest(Joy())
        self.subscription = self.node.create_subscription(Joy, "joy", self.on_joy, 1)

    def on_joy(self, message):
        self.joy.put(message)

    def initialize(self, io):
        self.track_l, self.track_r = io.body.actuator("TRACK_L"), io.body.actuator("TRACK_R")

    def control(self):
        axes = [min(max(axis, -1.0), 1.0) for axis in (*self.joy.get().axes, 0.0, 0.0)]
        x, y = map(dead_zone, axes[:2])
        self.track_l.ctrl = 1.0 * y - 0.5 * x
        self.track_r.ctrl = 1.0 * y + 0.5 * x

    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)

await drive.check(GentleTank)
"""

RAISES = """class Broken(GentleTank):
    def control(self):
        self.track_l.ctrl = self.speed

await drive.check(Broken)
"""

LOOPS = """class Loops(GentleTank):
    def on_joy(self, message):
        while True: pass

await drive.check(Loops)
"""

WIDGET = """
import ipywidgets
slider = ipywidgets.FloatSlider()

class Slides(GentleTank):
    def control(self):
        self.track_l.ctrl = slider.value

await drive.check(Slides)
"""

PROGRAM = """
import asyncio
program = asyncio.get_running_loop()

class Reaches(GentleTank):
    def control(self):
        program.call_soon(print)

await drive.check(Reaches)
"""


DOZES = """
import asyncio
from time import sleep

class Dozes(GentleTank):
    def control(self):
        sleep(1e9)

async def tick():
    while True:
        print("tick")
        await asyncio.sleep(0.05)

ticking = asyncio.get_running_loop().create_task(tick())
try:
    await drive.check(Dozes)
finally:
    ticking.cancel()
"""

pytestmark = pytest.mark.process


@pytest.fixture(scope="module")
def desk():
    with kernel() as desk:
        desk.run(RIGHT)
        yield desk


def test_answers_of_a_notebook(desk):
    run = desk.run
    said = run(RIGHT)
    assert "✗" not in said
    assert "\nAll right. " in said
    assert run("await drive.check(GentleTank)") == said, "the same on every run"

    said = run(RAISES)
    assert "control raised AttributeError: 'Broken' object has no attribute 'speed'" in said
    assert "  in control, line 3: self.track_l.ctrl = self.speed\n" in said
    said = run(LOOPS)
    assert "✗ on_joy does not return\n  in on_joy, line 3: while True: pass\n" in said
    assert "Reaches uses program, an object of the class" in run(PROGRAM)
    said = run(WIDGET)
    assert "Slides uses slider, an object of the class FloatSlider, that belongs to the notebook" in said, said


def test_the_kernel_stays_free_during_a_check(desk):
    said = desk.run(DOZES)
    assert "✗ control does not return" in said
    assert said.count("tick") > 5


def test_an_interrupted_check_leaves_nothing(desk):
    def processes():
        return len(desk.process.children(recursive=True))

    before = processes()
    reply = desk.interrupt(DOZES, lambda _: processes() > before)
    assert reply["status"] == "error"
    until(lambda: processes() == before, "the end of the process that judges")
    assert "All right." in desk.run("await drive.check(GentleTank)")
