"""A program within a kernel: what a notebook's cells do with it."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
import threading

import psutil
import pytest
from kernels import kernel
from programs import marked
from programs import until as wait_until
from rclpy.time import Time
from sensor_msgs.msg import JointState

from tutorial.controller import SimpleController
from tutorial.errors import TutorialError
from tutorial.notebook import close_all, open_node, open_program, until
from tutorial.paths import find_project
from tutorial.project import Project


@pytest.fixture
def in_a_cell(domain):
    """Run an async scenario as a cell would, and close everything."""

    def run(scenario):
        async def whole():
            try:
                await scenario()
            finally:
                close_all()

        asyncio.run(whole())

    return run


def joint_state(seconds, **positions):
    message = JointState(name=list(positions), position=list(positions.values()))
    message.header.stamp = Time(nanoseconds=round(seconds * 1e9)).to_msg()
    return message


def threads():
    return {thread.name for thread in threading.enumerate()}


def test_a_project_is_opened_by_name_run_and_closed(in_a_cell):
    before = threads()

    async def scenario():
        program = open_program("step1", node="simulation")
        assert repr(program) == "Program('simulation', bodies=['Labo', 'Tank'])"
        assert repr(program.view) == "SceneView('simulation')"
        await program.run(0.2)
        assert program.simulation.time == pytest.approx(0.2)
        await program.run(0.1)
        assert program.simulation.time == pytest.approx(0.3)
        assert program.error is None

    in_a_cell(scenario)
    assert threads() == before


def test_the_next_start_forgets_what_failed_before(in_a_cell):
    class Hasty(SimpleController):
        hasty = True

        def control(self):
            if self.hasty:
                raise ValueError("mine")

    async def scenario():
        program = open_program(Project.load(find_project("step1")).with_controllers("Tank", Hasty))
        for go_on in (program.start, lambda: program.advance(0.01)):
            Hasty.hasty = True
            program.start()
            await until(lambda: program.error)
            Hasty.hasty = False
            go_on()
            assert program.error is None

    in_a_cell(scenario)


def test_one_of_the_same_node_name_is_closed_first(in_a_cell):
    async def scenario():
        first = open_program("step3", node="viewer")
        open_program("step3", node="viewer")
        hand = open_node("hand")
        await until(lambda: hand.get_node_names().count("viewer") == 1)
        first.close()

    in_a_cell(scenario)


def test_it_draws_between_the_cells(in_a_cell):
    async def scenario():
        program = open_program("step1")
        shown = []
        program.body("Tank").on_change(shown.append)
        await until(lambda: shown, "a frame")

    in_a_cell(scenario)


def test_what_comes_in_is_counted_and_what_waits(in_a_cell):
    class Calm(SimpleController):
        def configure(self, config):
            self.node = config.node
            self.config = config
            config.node.create_subscription(JointState, "Tank/joint_state", self.on_joint_state, 1)

        def on_joint_state(self, message):
            self.config.call_latest("joints", list)

    async def scenario():
        project = Project.load(find_project("step3")).with_controllers("Tank", Calm)
        viewer = open_program(project, node="viewer")
        publisher = open_node("hand").create_publisher(JointState, "/Tank/joint_state", 1)
        await until(publisher.get_subscription_count)
        for i in range(3):
            publisher.publish(joint_state(i, TURRET_Y=0.1 * i))
            wait_until(lambda i=i: viewer.received == i + 1)
        assert viewer.waiting == 1
        await until(lambda: viewer.waiting == 0)

    in_a_cell(scenario)


def test_a_callback_on_the_wrong_thread_is_told(in_a_cell):
    class Naive(SimpleController):
        def configure(self, config):
            self.node = config.node
            self.body = config.body
            config.node.create_subscription(JointState, "Tank/joint_state", self.on_joint_state, 1)

        def on_joint_state(self, message):
            self.body.set_joint_positions({"TURRET_Y": 0.5})

    async def scenario():
        viewer = open_program(Project.load(find_project("step3")).with_controllers("Tank", Naive))
        publisher = open_node("hand").create_publisher(JointState, "/Tank/joint_state", 1)
        await until(publisher.get_subscription_count)
        publisher.publish(joint_state(0, TURRET_Y=0.5))
        await until(lambda: viewer.error)
        assert "was called on the thread 'executor', but the body 'Tank' belongs to the thread" in str(viewer.error)

    in_a_cell(scenario)


def test_what_there_is_not_is_said_with_the_nearest_name(in_a_cell):
    async def scenario():
        viewer = open_program("step3")
        with pytest.raises(TutorialError, match=r"this program has no body 'Tnak'\. Did you mean 'Tank'"):
            viewer.body("Tnak")
        with pytest.raises(TutorialError, match=r"no controller 'JointStatePublisher'\. Did you mean 'JointStateSubs"):
            viewer.controller("JointStatePublisher")
        with pytest.raises(TutorialError, match="this program only displays"):
            viewer.simulation.start()

    in_a_cell(scenario)


def test_time_that_passes_in_pieces_is_one_run(in_a_cell):
    """The barrel hangs by the weight of its gun below the reference that it had at first, and does not sink on."""

    async def scenario():
        program = open_program("step1")
        for _ in range(10):
            program.advance(0.02)
        program.advance(1.8)
        barrel = program.simulation.bodies["Tank"].joint("TURRET_P")
        assert barrel.position == pytest.approx(-9.80665 * 0.2 / 200, rel=0.01)

    in_a_cell(scenario)


def test_time_is_started_and_stopped_twice_and_not_when_closed(in_a_cell):
    async def scenario():
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

    in_a_cell(scenario)


def test_what_a_posted_call_raises_is_told_where_it_is_waited_for(in_a_cell):
    class Mistyped(SimpleController):
        def configure(self, config):
            self.node = config.node
            self.config = config
            config.node.create_subscription(JointState, "Tank/joint_state", self.on_joint_state, 1)

        def on_joint_state(self, message):
            self.config.call_later(self.update, message)

        def update(self, message):
            self.config.body.set_joint_position({"TURRET_Y": 0.5})

    async def scenario():
        viewer = open_program(Project.load(find_project("step3")).with_controllers("Tank", Mistyped))
        publisher = open_node("hand").create_publisher(JointState, "/Tank/joint_state", 1)
        await until(publisher.get_subscription_count)
        publisher.publish(joint_state(0, TURRET_Y=0.5))
        await until(lambda: viewer.error)
        assert isinstance(viewer.error, AttributeError)
        publisher.publish(joint_state(0, TURRET_Y=0.5))
        with pytest.raises(
            TutorialError, match=r"in vain for the turret\. Meanwhile: \[ERROR\] Mistyped of Tank: a call"
        ):
            await until(lambda: viewer.body().joint("TURRET_Y").position, "the turret", 1.0)

    in_a_cell(scenario)


def test_a_controller_that_never_returns_does_not_hold_the_kernel(domain):
    with kernel() as running:
        running.run(LOOPS)
        reply = running.interrupt("await program.run(600)", once=shows_the_bar)
        assert reply["ename"] == "EndedEarly"
        running.run("program = open_program('step1')\nawait program.run(0.1)")


LOOPS = """
from tutorial.notebook import *
from tutorial.controller import SimpleController
from tutorial.project import Project
from tutorial.paths import find_project
import time

class Loops(SimpleController):
    def control(self):
        while True:
            time.sleep(0.01)

program = open_program(Project.load(find_project("step1")).with_controllers("Tank", Loops))
"""


def test_two_kernels_do_not_hear_each_other(monkeypatch):
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    with kernel() as one, kernel() as other:
        say = "import os, tutorial.notebook\nprint(os.environ['ROS_DOMAIN_ID'])"
        assert one.run(say) != other.run(say)


OPEN_EVERYTHING = """
from tutorial.notebook import *
program = open_program("step2", node="simulation")
program.simulation.start()
node = open_node("hand")
widgets = joystick(), joint_plot(), node_graph(), chaos_panel("/faulty")
command = start_command("tank run step3 --headless --ros-args -r __node:=viewer")
await command.says("+ Tank")
await topic_echo("/Tank/joint_state", once=True, field="name")
"""


def test_a_killed_kernel_leaves_nothing_behind(domain, monkeypatch):
    monkeypatch.setenv("TANK_TEST_MARK", mark := f"kernel-{os.getpid()}-{domain}")
    with kernel() as running:
        assert running.run(OPEN_EVERYTHING) == "['TURRET_Y', 'TURRET_P']\n---\n"
        assert len(marked(mark)) > 1
        assert {port.laddr.ip for port in listening(running.process)} <= {"127.0.0.1"}
        running.process.send_signal(signal.SIGKILL)
        wait_until(lambda: not marked(mark), f"the end of {marked(mark)}")


def test_a_kernel_that_is_shut_down_leaves_nothing_behind(domain, monkeypatch):
    monkeypatch.setenv("TANK_TEST_MARK", mark := f"kernel-{os.getpid()}-{domain}")
    with kernel() as running:
        running.run(OPEN_EVERYTHING)
        running.client.shutdown()
        wait_until(lambda: not marked(mark), f"the end of {marked(mark)}")


def test_everything_closed_leaves_the_kernel_with_its_own_threads(domain):
    with kernel() as running:
        before = running.run("import threading\nprint(sorted(t.name for t in threading.enumerate()))")
        running.run(OPEN_EVERYTHING)
        running.run("close_all()\nclose_all()")
        assert running.run("print(sorted(t.name for t in threading.enumerate()))") == before


def test_an_interrupted_run_stops_cleanly_and_goes_on_later(domain):
    with kernel() as running:
        running.run("from tutorial.notebook import *\nprogram = open_program('step1')")
        reply = running.interrupt("await program.run(600)", once=moves_the_bar)
        assert reply["ename"] == "EndedEarly"
        assert len(reply["traceback"]) == 1
        assert running.run("print(program.simulation.running)\nawait program.run(0.1)") == "False\n"


def shows_the_bar(message):
    return message["msg_type"] == "display_data"


def moves_the_bar(message):
    return message["msg_type"] == "comm_msg" and message["content"]["data"].get("state", {}).get("value", 0) > 0


def listening(process):
    return [c for c in process.net_connections("tcp") if c.status == psutil.CONN_LISTEN and c.family == socket.AF_INET]
