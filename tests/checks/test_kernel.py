"""The checks as a notebook uses them: classes that live in a kernel's ``__main__``, and cells that use ``await``."""

import pytest
from kernels import kernel
from programs import until

pytestmark = pytest.mark.process

RIGHT = "await drive.check(GentleTank)"
CLASS = """
from tutorial.checks.drive import GentleTank as Solution
from tutorial.checks.tank_controller import drive

class GentleTank(Solution):
    def control(self):
        super().control()
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


@pytest.fixture(scope="module")
def desk():
    with kernel() as desk:
        desk.run(CLASS)
        yield desk


def test_answers_of_a_notebook(desk):
    run = desk.run
    said = run(RIGHT)
    assert "✗" not in said
    assert "\nAll right. " in said
    assert run(RIGHT) == said, "the same on every run"


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
    assert "All right." in desk.run(RIGHT)
