"""One running program: its items, its threads, and what happens when they go while messages arrive."""

from __future__ import annotations

import asyncio
import logging
import textwrap
import threading
from dataclasses import replace
from pathlib import Path

import pytest
from geometry_msgs.msg import Pose
from programs import PATIENCE
from sensor_msgs.msg import JointState

from tutorial import project as project_module
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError
from tutorial.host import Host
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import ControllerError
from tutorial.view.bodies import View
from tutorial.view.scene import Scene


async def until(condition, what="the condition"):
    deadline = asyncio.get_running_loop().time() + PATIENCE
    while not condition():
        assert asyncio.get_running_loop().time() < deadline, f"waited in vain for {what}"
        await asyncio.sleep(0.005)


def message(position, nanoseconds, name="TURRET_Y"):
    state = JointState(name=[name], position=[position])
    state.header.stamp.sec, state.header.stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
    return state


class Flood:
    """Publishes joint states as fast as it can, on a thread of its own."""

    def __init__(self):
        self._thread_node = NodeThread("flood")
        self.publisher = self._thread_node.node.create_publisher(JointState, "/Tank/joint_state", 1)
        self.count = 0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self):
        while not self._stop.wait(0.0005):
            self.count += 1
            self.publisher.publish(message(0.001 * (self.count % 100), self.count * 1_000_000))

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()
        self._thread_node.close()


@pytest.fixture
def step3(domain):
    return Project.load(find_project("step3"))


def threads():
    return {thread for thread in threading.enumerate() if not thread.name.startswith("Dummy")}


def test_a_message_moves_the_displayed_body_on_the_main_thread(step3):
    async def scenario():
        async with Host(step3) as host:
            with NodeThread("tester") as tester:
                publisher = tester.node.create_publisher(JointState, "/Tank/joint_state", 1)
                await until(publisher.get_subscription_count, "the match")
                seen_on = []
                host.bodies["Tank"].on_change(lambda report: seen_on.append((threading.current_thread(), str(report))))
                publisher.publish(message(0.5, 1))
                await until(lambda: seen_on, "the update")
                assert seen_on == [(threading.main_thread(), "1 joint shown")]
                assert host.bodies["Tank"].joint("TURRET_Y").position == 0.5
                assert host.record()["report"]["matched"] == 1

    before = threads()
    asyncio.run(scenario())
    assert threads() == before, "no thread is left"


def test_a_body_may_be_deleted_while_messages_arrive(step3, caplog):
    async def scenario():
        scene = Scene()
        view = View(scene)
        async with Host(step3, view=view) as host:
            run = asyncio.ensure_future(host.run())
            with Flood() as flood:
                await until(lambda: host.bodies["Tank"].joint("TURRET_Y").position > 0, "the first updates")
                body = host.bodies["Tank"]
                host.remove("Tank")
                pose = body.qpos.copy()
                sent = flood.count
                await until(lambda: flood.count > sent + 200, "more messages")
                assert host.bodies == {}
                assert view.names == ()
                assert (body.qpos == pose).all(), "what was posted for it does not run any more"
                assert not host.node.count_subscribers("/Tank/joint_state")
                assert not run.done()
            run.cancel()
            with pytest.raises(asyncio.CancelledError):
                await run

    with caplog.at_level(logging.WARNING):
        asyncio.run(scenario())
    assert not [record for record in caplog.records if record.levelno >= logging.ERROR], caplog.text


def test_an_unknown_body_is_named_with_the_nearest(step3):
    async def scenario():
        async with Host(step3) as host:
            host.remove("Tnak")

    with pytest.raises(TutorialError, match=r"there is no body 'Tnak'\. Did you mean 'Tank'\?"):
        asyncio.run(scenario())


def test_a_simulated_body_may_be_deleted_while_it_is_stepped(domain):
    async def scenario():
        async with Host(Project.load(find_project("step2"))) as host:
            run = asyncio.ensure_future(host.run())
            await until(lambda: host.simulation.step > 50, "the first steps")
            host.remove("Tank")
            step = host.simulation.step
            await until(lambda: host.simulation.step > step + 50, "more steps")
            run.cancel()
            with pytest.raises(asyncio.CancelledError):
                await run
            assert host.simulation.error is None

    asyncio.run(scenario())


def test_a_controller_that_does_not_return_holds_up_neither_remove_nor_close(domain, monkeypatch):
    monkeypatch.setattr("tutorial.simulation.STUCK", 0.2)
    there, let = threading.Event(), threading.Event()

    class Hangs(SimpleController):
        def control(self):
            there.set()
            let.wait(60)

    async def scenario():
        project = Project.load(find_project("step2"))
        bodies = [replace(item, controllers=(*item.controllers, Hangs)) for item in project.bodies]
        async with Host(replace(project, bodies=bodies)) as host:
            run = asyncio.ensure_future(host.run())
            await until(there.is_set, "the first step")
            with pytest.raises(ControllerError, match=r"Hangs does not return: it is at test_host\.py, line \d+, in c"):
                host.remove("Tank")
            with pytest.raises(ControllerError, match="Mend it, and make the simulation anew: open its program again"):
                await run

    before = threads()
    try:
        asyncio.run(scenario())
    finally:
        let.set()
    for thread in threads() - before:
        thread.join(PATIENCE)
        assert not thread.is_alive()


def test_a_simulating_program_shows_its_copy(domain):
    async def scenario():
        async with Host(Project.load(find_project("step2"))) as host:
            start = host.bodies["Tank"].qpos.copy()
            progress = []
            await host.run(0.3, progress=progress.append)
            assert host.seconds == pytest.approx(0.3)
            assert progress == sorted(progress)
            assert not (host.bodies["Tank"].qpos == start).all()
            assert (host.bodies["Tank"].qpos == host.simulation.bodies["Tank"].qpos).all()
            assert host.record()["topics"]["/Tank/joint_state"]["published"] == 15

    asyncio.run(scenario())


def test_what_is_wrong_with_the_messages_is_one_throttled_line(step3, caplog):
    async def scenario():
        async with Host(step3) as host:
            with NodeThread("tester") as tester:
                publisher = tester.node.create_publisher(JointState, "/Tank/joint_state", 10)
                await until(publisher.get_subscription_count, "the match")
                for i in range(1, 20):
                    publisher.publish(message(0.1, i, name="TURET_Y"))
                    await until(lambda i=i: host.record()["report"]["unknown"] == i, "the update")

    with caplog.at_level(logging.WARNING):
        asyncio.run(scenario())
    assert caplog.text.count("unknown 'TURET_Y'. Did you mean 'TURRET_Y'?") == 1


class Naive(SimpleController):
    """The naive callback of step 3: it touches the display from the executor's thread."""

    def configure(self, config):
        self.body = config.body
        self.node = config.node
        topic = f"{config.body.name}/joint_state"
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1)

    def on_joint_state(self, message):
        self.body.set_joint_positions({"TURRET_Y": 1.0})

    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)


class Unfit(SimpleController):
    def configure(self, config):
        raise ValueError("mine")


@pytest.fixture
def project_with(domain, tmp_path, monkeypatch):
    """A project whose tank has a controller of the test's own."""

    def make(controller):
        monkeypatch.setattr(project_module, "find_controller", lambda _: controller)
        path = tmp_path / "project.yaml"
        models = Path(find_project("step3")).parent / "models"
        path.write_text(
            textwrap.dedent(f"""
            bodies:
              - name: Tank
                model: {models}/tank.xml
                controllers: [Mine]
            """)
        )
        return Project.load(path)

    return make


def test_the_naive_callback_is_told_whose_the_body_is(project_with, caplog):
    async def scenario():
        async with Host(project_with(Naive)) as host:
            with NodeThread("tester") as tester:
                publisher = tester.node.create_publisher(JointState, "/Tank/joint_state", 1)
                await until(publisher.get_subscription_count, "the match")
                publisher.publish(message(0.1, 1))
                await until(lambda: "WrongThreadError" in caplog.text, "the error")
                assert host.bodies["Tank"].joint("TURRET_Y").position == 0.0

    asyncio.run(scenario())
    assert (
        "set_joint_positions was called on the thread 'executor', but the body 'Tank' belongs to the thread "
        "'MainThread'. Post the call instead: call_later(f, message)."
    ) in caplog.text


class Poser(SimpleController):
    """Publishes a message that has a position, and is no joint state."""

    def configure(self, config):
        config.node.create_publisher(Pose, "pose", 1).publish(Pose())


class Clumsy(SimpleController):
    """Fails once, as a posted call and as a callback."""

    def configure(self, config):
        config.call_later(lambda: 1 / 0)
        config.node.create_subscription(JointState, "Tank/joint_state", lambda message: {}["mine"], 1)


def test_a_message_without_a_header_is_recorded_too(project_with):
    async def scenario():
        async with Host(project_with(Poser)) as host:
            record = host.record()
            assert record["topics"]["/pose"]["published"] == 1
            assert list(record["joints"]) == list(host.bodies["Tank"].joint_names)

    asyncio.run(scenario())


def test_a_new_run_forgets_what_failed_before(project_with):
    async def scenario():
        scene = Scene()
        async with Host(project_with(Clumsy), view=View(scene)) as host:
            with NodeThread("tester") as tester:
                publisher = tester.node.create_publisher(JointState, "/Tank/joint_state", 1)
                await until(publisher.get_subscription_count, "the match")
                await until(lambda: isinstance(host.error, ZeroDivisionError), "the posted call's error")
                publisher.publish(message(0.1, 1))
                await until(lambda: isinstance(host.error, KeyError), "the callback's error")
            await host.run(0.01)
            assert host.error is None

    asyncio.run(scenario())


def test_a_controller_that_cannot_join_its_body_is_named_and_nothing_is_left(project_with):
    before = threads()

    async def scenario():
        async with Host(project_with(Unfit)):
            pass

    with pytest.raises(
        TutorialError, match=r"Unfit could not join Tank: test_host.py, line \d+, in configure: ValueError: mine"
    ):
        asyncio.run(scenario())
    assert threads() == before


def test_closing_twice_does_nothing(step3):
    async def scenario():
        host = Host(step3)
        host.close()
        host.close()

    asyncio.run(scenario())
