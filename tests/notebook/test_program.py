"""A program within a kernel, used as in a notebook's cells."""

import math
import os
import re
import signal
import socket
import threading
from functools import partial

import psutil
import pytest
from kernels import kernel
from programs import marked
from programs import until as wait_until
from scenes import commands, lines
from sensor_msgs.msg import JointState

from tutorial.controller import SimpleController
from tutorial.errors import TutorialError
from tutorial.notebook import close_all, open_node, open_program, until
from tutorial.notebook import program as program_module
from tutorial.notebook.widgets.cell_widget import CellWidget
from tutorial.program.project import Project
from tutorial.simulation import REST
from tutorial.system.paths import find_project

pytestmark = pytest.mark.usefixtures("domain")


def with_controller(project, controller):
    return Project.load(find_project(project)).with_controllers("Tank", controller)


async def test_a_program_is_opened_run_drawn_and_closed():
    before = {thread.name for thread in threading.enumerate()}
    program = open_program("step1", node="simulation")
    assert repr(program) == "Program('simulation', bodies=['Labo', 'Tank'])"
    assert repr(program.view) == "SceneView('simulation')"
    await program.run(0.2)
    assert program.simulation.time == pytest.approx(0.2)
    await program.run(0.1)
    assert program.simulation.time == pytest.approx(0.3)
    assert program.error is None
    shown = []
    program.body("Tank").on_change(shown.append)
    await until(lambda: shown, "a frame")
    close_all()
    assert {thread.name for thread in threading.enumerate()} <= before
    assert repr(program) == "Program('simulation', closed)"


def shown_frames(program):
    """Return the frames whose axes a newly opened page shows."""
    every = commands(program.view.scene.snapshot())
    return [
        each["path"].rpartition("/")[2]
        for each in every
        if each.get("property") == "visible" and "frames" in each["path"] and each["value"]
    ]


async def test_frames_are_shown_and_hidden():
    program = open_program("step7", node="simulation")
    assert shown_frames(program) == []
    program.show_frames("Tank/base_link")
    assert shown_frames(program) == ["Tank.base_link"]
    program.show_frames()
    names = ["odom", "Tank.base_link", "Tank.TURRET_Y_link", "Tank.TURRET_P_link", "Tank.CAMERA_optical"]
    assert shown_frames(program) == names
    program.hide_frames()
    assert shown_frames(program) == []
    program.close()
    with pytest.raises(TutorialError, match="closed"):
        program.show_frames()


async def test_a_new_start_forgets_the_last_error():
    class Hasty(SimpleController):
        hasty = True

        def control(self):
            if self.hasty:
                raise ValueError("mine")

    program = open_program(with_controller("step1", Hasty))
    for go_on in (program.start, lambda: program.advance(0.01)):
        Hasty.hasty = True
        program.start()
        await until(lambda: program.error)
        Hasty.hasty = False
        go_on()
        assert program.error is None


async def test_a_program_with_the_same_node_name_is_closed_first():
    first = open_program("step3", node="viewer")
    viewer = open_program("step3", node="viewer")
    hand = open_node("hand")
    await until(lambda: hand.get_node_names().count("viewer") == 1)
    first.close()
    with pytest.raises(TutorialError, match=r"this program has no body 'Tnak'\. Did you mean 'Tank'"):
        viewer.body("Tnak")
    with pytest.raises(TutorialError, match=r"no controller 'JointStatePublisher'\. Did you mean 'JointStateSubs"):
        viewer.controller("JointStatePublisher")
    with pytest.raises(TutorialError, match="this program does not simulate"):
        viewer.simulation.start()


async def test_received_and_waiting_messages_are_counted():
    class Posts(SimpleController):
        def configure(self, config):
            post = partial(config.call_latest, "joints", list)
            config.node.create_subscription(JointState, "Tank/joint_state", lambda _: post(), 1)

    viewer = open_program(with_controller("step3", Posts))
    publisher = open_node("hand").create_publisher(JointState, "/Tank/joint_state", 1)
    await until(publisher.get_subscription_count)
    for i in range(3):
        publisher.publish(JointState())
        wait_until(lambda i=i: viewer.received == i + 1)
    assert viewer.waiting == 1
    await until(lambda: viewer.waiting == 0)


async def test_starting_twice_is_harmless_and_a_closed_program_refuses():
    program = open_program("step1")
    program.start()
    program.start()
    assert program.simulation.running
    program.advance(0.1)
    assert not program.simulation.running
    program.stop()
    program.close()
    for act in (program.start, lambda: program.advance(0.1)):
        with pytest.raises(TutorialError, match=r"this program is closed\. Run the cell with open_program again\."):
            act()
    with pytest.raises(TutorialError, match="this program is closed"):
        await program.run(0.1)


async def test_a_simulation_rests_only_after_its_page_was_closed(monkeypatch):
    def below():
        return lines(program.view.whole()[0])[0]

    monkeypatch.setattr(CellWidget, "heard_at", math.inf)
    monkeypatch.setattr(program_module, "REST_AFTER", 0.0)
    program = open_program("step1")
    program.start()
    await until(lambda: program.simulation.time > 0.2)
    program.view._handle_custom_msg({"type": "here", "view": "page"}, [])
    await until(lambda: not program.simulation.running)
    assert re.match(r"paused at [\d.]+ s, after 0 min without an open page: call start\(\) to resume", below())
    program.advance(0.1)
    await program.run(0.1)
    monkeypatch.setattr(program_module, "REST_AFTER", 300.0)
    program.start()
    await until(lambda: "paused" not in below())
    assert program.simulation.running
    assert program.simulation.rest == REST
    monkeypatch.setattr(CellWidget, "heard_at", -math.inf)
    await until(lambda: program.simulation.rest > REST)


LOOPS = """
from tutorial.controller import SimpleController
from tutorial.program.project import Project
from tutorial.system.paths import find_project
import time

class Loops(SimpleController):
    def control(self):
        while True:
            time.sleep(0.01)

program = open_program(Project.load(find_project("step1")).with_controllers("Tank", Loops))
"""
OPEN_EVERYTHING = """
from tutorial.notebook import *
program = open_program("step2", node="simulation")
program.simulation.start()
node = open_node("hand")
widgets = joystick(), joint_plot(), node_graph(), chaos_panel()
command = start_command("tank run step3 --headless --ros-args -r __node:=viewer")
await command.says("+ Tank")
await topic_echo("/Tank/joint_state", once=True, field="name")
"""
THREADS = "import threading\nprint(sorted(t.name for t in threading.enumerate()))"


@pytest.fixture
def family(domain, monkeypatch):
    """The processes of the kernels started from now on, with all their descendants."""
    monkeypatch.setenv("TANK_TEST_MARK", mark := f"kernel-{os.getpid()}-{domain}")
    return partial(marked, mark)


@pytest.mark.process
def test_an_interrupted_kernel_goes_on_and_shuts_down_cleanly(family):
    with kernel() as running:
        before = running.run(THREADS)
        running.run("from tutorial.notebook import *\nprogram = open_program('step1')")
        reply = running.interrupt("await program.run(600)", once=moves_the_bar)
        assert reply["ename"] == "EndedEarly"
        assert len(reply["traceback"]) == 1
        assert running.run("print(program.simulation.running)\nawait program.run(0.1)") == "False\n"
        running.run(OPEN_EVERYTHING)
        running.run("close_all()\nclose_all()")
        assert running.run(THREADS) == before
        running.run(LOOPS)
        reply = running.interrupt("await program.run(600)", once=shows_the_bar)
        assert reply["ename"] == "EndedEarly", "a controller that never returns does not block the kernel"
        running.run("program = open_program('step1')\nawait program.run(0.1)")
        running.run(OPEN_EVERYTHING)
        running.client.shutdown()
        wait_until(lambda: not family(), f"the end of {family()}")


@pytest.mark.process
def test_a_killed_kernel_leaves_no_processes(family):
    with kernel() as running:
        assert running.run(OPEN_EVERYTHING) == "['TURRET_Y', 'TURRET_P']\n---\n"
        assert len(family()) > 1
        assert {port.laddr.ip for port in listening(running.process)} <= {"127.0.0.1"}
        running.process.send_signal(signal.SIGKILL)
        wait_until(lambda: not family(), f"the end of {family()}")


def shows_the_bar(message):
    return message["msg_type"] == "display_data"


def moves_the_bar(message):
    return message["msg_type"] == "comm_msg" and message["content"]["data"].get("state", {}).get("value", 0) > 0


def listening(process):
    return [c for c in process.net_connections("tcp") if c.status == psutil.CONN_LISTEN and c.family == socket.AF_INET]
