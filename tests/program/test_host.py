"""A running program: its items, its threads, and removing them while messages arrive."""

import asyncio
import logging
import random
import re
import threading
import time
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from itertools import count
from operator import attrgetter

import pytest
from geometry_msgs.msg import Pose
from loops import TIMEOUT, in_a_loop, until
from sensor_msgs.msg import JointState

from tutorial.controller import SimpleController
from tutorial.errors import RefusedError, TutorialError
from tutorial.program.host import Host
from tutorial.program.project import BodyItem, Project
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import ControllerError, State
from tutorial.system.paths import find_project
from tutorial.view.bodies import View
from tutorial.view.scene import Record, Scene, unpack_records
from tutorial.world import Placement

TOPIC = "/Tank/joint_state"


@asynccontextmanager
async def publishers(*topics):
    """Yield publishers on one node, once the program has found them."""
    with NodeThread("tester") as tester:
        made = [tester.node.create_publisher(JointState, topic, 1) for topic in topics]
        for publisher in made:
            await until(publisher.get_subscription_count)
        yield made


def message(position, nanoseconds, names=("TURRET_Y",)):
    state = JointState(name=list(names), position=[position] * len(names))
    state.header.stamp.sec, state.header.stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
    return state


def flood(node):
    """Publish joint states as fast as possible, and yield a list that counts them."""

    def publish():
        sent.append(len(sent) + 1)
        publisher.publish(message(0.001 * (sent[-1] % 100), sent[-1] * 1_000_000))

    sent, publisher = [], node.create_publisher(JointState, TOPIC, 1)
    node.create_timer(0.0005, publish)
    return sent


@pytest.fixture
def step2(domain):
    return Project.load(find_project("step2"))


@pytest.fixture
def step3(domain):
    return Project.load(find_project("step3"))


def drawn(scene, kind):
    """Return a scene's commands of a kind, such as the lines below the view."""
    return [payload for each, payload in unpack_records(scene.snapshot()) if each is kind]


def watched_view():
    view = View(scene := Scene())
    scene.attach(lambda _: None)
    return view


def threads():
    return {thread for thread in threading.enumerate() if not thread.name.startswith("Dummy")}


@in_a_loop
async def test_a_message_moves_the_displayed_body_on_the_main_thread(step3):
    before = threads()
    async with Host(step3) as host, publishers(TOPIC) as [publisher]:
        seen_on = []
        host.bodies["Tank"].on_change(lambda report: seen_on.append((threading.current_thread(), str(report))))
        publisher.publish(message(0.5, 1))
        await until(lambda: seen_on)
        assert seen_on == [(threading.main_thread(), "1 joint shown")]
        assert host.bodies["Tank"].joint("TURRET_Y").position == 0.5
        assert host.record()["report"]["matched"] == 1
    assert threads() <= before, "no thread is left"


@pytest.mark.parametrize(("project", "close_up"), [("step3", True), ("step2", False)])
@in_a_loop
async def test_the_view_is_close_to_robots_and_far_from_a_laboratory(domain, project, close_up):
    View(usual := Scene())
    async with Host(Project.load(find_project(project)), view=View(scene := Scene())):
        assert (drawn(scene, Record.CAMERA) != drawn(usual, Record.CAMERA)) == close_up


@in_a_loop
async def test_it_follows_one_of_two_publishers_until_it_leaves(step3, caplog):
    async with Host(step3) as host:
        subscription = host.controllers["JointStateSubscriber"].subscription

        async def say(publisher, position, milliseconds):
            before = host.record()["report"]
            publisher.publish(message(position, milliseconds * 1_000_000))
            await until(lambda: host.record()["report"] != before)
            return host.bodies["Tank"].joint("TURRET_Y").position

        with NodeThread("one") as one, NodeThread("other") as other:
            first, second = (each.node.create_publisher(JointState, TOPIC, 1) for each in (one, other))
            await until(lambda: subscription.get_publisher_count() == host.node.count_publishers(TOPIC) == 2)
            await until(lambda: first.get_subscription_count() and second.get_subscription_count())
            for i in range(1, 30):  # like stamps, 3 ms apart
                assert await say(first, 0.5, 20 * i) == 0.5
                assert await say(second, -0.5, 20 * i + 3) == 0.5
            assert f"Tank: 2 nodes publish on {TOPIC}; only one of these is followed: /one, /other" in caplog.messages
            one.close()
            await until(lambda: subscription.get_publisher_count() == 1)
            assert await say(second, -0.5, 600) == -0.5


@in_a_loop
async def test_without_a_viewer_no_frame_is_drawn(step3, monkeypatch):
    view, frames = View(scene := Scene()), []
    async with Host(step3, view=view) as host:
        monkeypatch.setattr(view, "flush", lambda: frames.append("drawn"))
        host.refresh()
        assert not frames
        assert drawn(scene, Record.LINE) == [b"Tank: no message on /Tank/joint_state yet"]
        scene.attach(len)
        host.refresh()
        assert len(frames) == 2


@in_a_loop
async def test_the_line_below_the_view_shows_the_sensors(domain):
    async with Host(Project.load(find_project("step5")), view=View(scene := Scene())) as host:
        host.bodies["Tank"].sensor("ACCEL_SENSOR").value = -3.0, 0.0, 9.8
        assert "Tank\tacceleration\t-3.00\t0.00\t9.80\tm/s²\t" in drawn(scene, Record.LINE)[-1].decode()


@in_a_loop
async def test_a_body_can_be_removed_and_added_while_messages_arrive(step3, caplog):
    view = watched_view()
    async with Host(step3, view=view) as host:
        run = asyncio.ensure_future(host.run())
        with NodeThread("flood") as flooding:
            sent = flood(flooding.node)

            async def remove():
                body = host.bodies["Tank"]
                await until(lambda: body.joint("TURRET_Y").position > 0)
                host.remove("Tank")
                assert (host.bodies, view._bodies) == ({}, {})
                return body

            for _ in range(3):
                await remove()
                host.add(step3.bodies[0])
                assert list(view._bodies) == ["Tank"]
            await until(lambda: host.node.count_subscribers(TOPIC) == 1)
            body = await remove()
            pose, count = body.qpos.copy(), len(sent)
            await until(lambda: len(sent) > count + 200)
            assert (body.qpos == pose).all(), "its posted calls no longer run"
            await until(lambda: not host.node.count_subscribers(TOPIC))
        assert not run.done()
        run.cancel()
    assert not [each for each in caplog.records if each.levelno >= logging.ERROR], caplog.text


class Asking(SimpleController):
    def configure(self, config):
        Asking.ask = config.ask


@in_a_loop
async def test_requests_are_refused_when_their_controller_leaves(step2, step3):
    async with Host(step3.with_controllers("Tank", Asking)):
        with pytest.raises(RefusedError, match="this program has no simulation"):
            Asking.ask(print)
    async with Host(step2.with_controllers("Tank", Asking)) as host:
        with pytest.raises(RefusedError, match="is not running"):
            Asking.ask(print)
        host.simulation.start()
        assert Asking.ask(divmod, 7, 2) == (3, 1)
        host.remove("Tank")
        with pytest.raises(RefusedError, match=r"Asking of Tank has left the program\."):
            Asking.ask(print)


class Unfit(SimpleController):
    def configure(self, config):
        Unfit.call_later = config.call_later
        raise ValueError("mine")


@in_a_loop
async def test_a_body_that_cannot_join_changes_nothing(step2, step3):
    [item] = step3.bodies
    unfit = BodyItem(replace(item.placement, name="Other"), (*item.controllers, Unfit))
    async with Host(step3, view=watched_view()) as host:
        with pytest.raises(TutorialError, match=r"there is already a body 'Tank'\. Remove it first"):
            host.add(item)
        with pytest.raises(TutorialError, match=r"Unfit could not join Other: test_host.py, line \d+, in configure: V"):
            host.add(unfit)
        Unfit.call_later(print)
        assert (list(host.bodies), host.waiting) == (["Tank"], 0)
        await until(lambda: not host.node.count_subscribers("/Other/joint_state"))
        with pytest.raises(TutorialError, match=r"there is no body 'Tnak'\. Did you mean 'Tank'\?"):
            host.remove("Tnak")
    with pytest.raises(TutorialError, match=r"this program is closed\."):
        host.add(item)
    async with Host(step2) as host:
        with pytest.raises(TutorialError, match="'Other' cannot join a simulation"):
            host.add(unfit)
    before = threads()
    with pytest.raises(TutorialError, match="Unfit could not join Tank"):
        Host(step3.with_controllers("Tank", Unfit))
    assert threads() <= before


@in_a_loop
async def test_each_body_of_a_fleet_follows_its_own_messages(domain):
    fleet = Project.load(find_project("fleet"))
    both = ("TURRET_Y", "TURRET_P")
    sent = {"Tank_1": message(0.1, 3, both), "Tank_2": message(0.3, 2, both), "Tank_3": message(0.5, 1, ["TRACK"])}
    async with Host(replace(fleet, bodies=fleet.bodies[:4]), view=View(scene := Scene())) as host:
        async with publishers(*(f"/{name}/joint_state" for name in sent)) as made:

            def said():
                for publisher, state in zip(made, sent.values()):
                    publisher.publish(state)
                return drawn(scene, Record.LINE)[-1].decode()

            fourth = "Tank_4: no message on /Tank_4/joint_state yet"
            line = rf"2 of 4 bodies follow their messages \| Tank_3: 0 joints shown; unknown 'TRACK'.* \| {fourth}"
            await until(lambda: re.fullmatch(line, said()))
        assert [body.joint("TURRET_Y").position for body in host.bodies.values()] == [0.1, 0.3, 0.0, 0.0]
        assert host.record()["report"]["late"] == 0, "a stamp on one topic makes no message on another late"


@pytest.fixture
def hanging(step2, monkeypatch):
    """A project whose tank has a hanging controller, and the event that it sets."""
    monkeypatch.setattr("tutorial.simulation.STUCK", 0.05)
    there, let = threading.Event(), threading.Event()

    class Hangs(SimpleController):
        def control(self):
            there.set()
            let.wait(60)

    before = threads()
    bodies = tuple(replace(item, controllers=(*item.controllers, Hangs)) for item in step2.bodies)
    yield replace(step2, bodies=bodies), there
    let.set()
    for thread in threads() - before:
        thread.join(TIMEOUT)
        assert not thread.is_alive()


@in_a_loop
async def test_a_hanging_controller_does_not_block_remove_or_close(hanging):
    project, there = hanging
    async with Host(project, view=watched_view()) as host:
        run = asyncio.ensure_future(host.run())
        await until(there.is_set)
        with pytest.raises(ControllerError, match=r"Hangs does not return: it is at test_host\.py, line \d+, in c"):
            host.remove("Tank")
        assert list(host.bodies) == ["Labo"], "the displayed body is removed anyway"
        with pytest.raises(ControllerError, match="Fix the code, then open the program again: this simulation cannot"):
            await run
        host.remove("Labo")
        assert host.bodies == {}
        with pytest.raises(ControllerError, match="Hangs does not return"):
            await host.run()
        assert "Hangs does not return" in str(host.error), "a refused start keeps the error"


@in_a_loop
async def test_a_run_with_a_duration_ends_despite_a_hanging_controller(hanging, monkeypatch):
    project, there = hanging

    def look(_):
        if there.is_set():
            monkeypatch.setattr("tutorial.program.run.HUNG", 0.05)

    async with Host(project) as host:
        with pytest.raises(ControllerError, match="Hangs does not return"):
            await asyncio.wait_for(host.run(1.0, progress=look), TIMEOUT)


@in_a_loop
async def test_a_program_can_be_closed_while_it_runs_and_twice(step3):
    host = Host(step3, view=watched_view())
    await asyncio.wait_for(host.run(progress=lambda _: host.close()), TIMEOUT)
    host.close()
    with pytest.raises(TutorialError, match=r"this program is closed\. Open it again\."):
        await host.run(0.1)


@in_a_loop
async def test_a_simulating_program_shows_its_copy(step2):
    async with Host(step2) as host:
        start, progress = host.bodies["Tank"].qpos.copy(), []
        await host.run(0.3, progress=progress.append)
        assert host.seconds == pytest.approx(0.3)
        assert progress == sorted(progress)
        assert not (host.bodies["Tank"].qpos == start).all()
        assert (host.bodies["Tank"].qpos == host.simulation.bodies["Tank"].qpos).all()
        assert host.record()["topics"][TOPIC]["published"] == 15


class Poser(SimpleController):
    """Publishes a message with a position that is not a joint state, and tries to exit the program when it leaves."""

    def configure(self, config):
        config.node.create_publisher(Pose, "pose", 1).publish(Pose())

    def unconfigure(self):
        raise SystemExit("mine")


@in_a_loop
async def test_a_message_without_a_header_is_recorded_and_a_failed_leave_is_an_error(step3, caplog):
    host = Host(step3.with_controllers("Tank", Poser))
    record = host.record()
    with pytest.raises(TutorialError, match=r"a controller failed in unconfigure\(\). The log shows where"):
        async with host:
            pass
    assert record["topics"]["/pose"]["published"] == 1
    assert list(record["joints"]) == list(host.bodies["Tank"].joint_names)
    assert "Poser of Tank failed in unconfigure()" in caplog.text
    assert "SystemExit: mine" in caplog.text


class Clumsy(SimpleController):
    """Fails once in a posted call and once in a callback."""

    def configure(self, config):
        config.call_later(lambda: 1 / 0)
        config.node.create_subscription(JointState, "Tank/joint_state", lambda message: {}["mine"], 1)


@in_a_loop
async def test_a_new_run_forgets_the_last_error(step3):
    async with Host(step3.with_controllers("Tank", Clumsy), view=watched_view()) as host:
        async with publishers(TOPIC) as [publisher]:
            await until(lambda: isinstance(host.error, ZeroDivisionError))
            publisher.publish(message(0.1, 1))
            await until(lambda: isinstance(host.error, KeyError))
        await host.run(0.01)
        assert host.error is None


NUMBERS = count()


class Unruly(SimpleController):
    """Misbehaves in a random way that the host has to survive.

    Attributes:
        rng: chooses the method and the misbehaviour.
        let: releases it when it hangs.
        made: all instances.
    """

    def __init__(self):
        others = ("configure", "initialize", "stop", "unconfigure", "posted")
        self.method = self.rng.choice((*others, *["control"] * 3, *["called_back"] * 2))
        self.act = self.rng.choice((None, None, ValueError, SystemExit, KeyboardInterrupt, "hang"))
        on_main = self.method in ("configure", "posted", "unconfigure")
        if on_main and self.act in ("hang", KeyboardInterrupt):
            self.act = SystemExit  # the reader has to interrupt what hangs on the main thread
        self.wait = self.rng.randrange(20)
        self.hangs, self.raised = False, []  # whether it hangs or hung; the texts of its exceptions
        self.made.append(self)

    def configure(self, config):
        self.config = config
        self.perhaps("configure")
        self.timer = config.node.create_timer(0.005, self.called_back)

    def called_back(self):
        self.config.call_later(self.perhaps, "posted")
        self.perhaps("called_back")

    def initialize(self, io):
        self.perhaps("initialize")

    def control(self):
        self.perhaps("control")

    def stop(self):
        self.perhaps("stop")

    def unconfigure(self):
        self.config.node.destroy_timer(self.timer)
        self.perhaps("unconfigure")

    def perhaps(self, method):
        self.wait -= method == "control"
        if method != self.method or self.act is None or (method == "control" and self.wait > 0):
            return
        if self.act == "hang":
            self.hangs = True
            self.let.wait(60)
        else:
            self.wait = 20
            self.raised.append(f"failure {next(NUMBERS)}.")
            raise self.act(self.raised[-1])


async def some_frames(host, rng):
    run = asyncio.ensure_future(host.run())
    await asyncio.sleep(rng.uniform(0.0, 0.05))
    rng.choice((run.cancel, run.cancel, host.close))()
    with suppress(asyncio.CancelledError):
        await run


ACTS = (
    *(("run", 0.02), ("run", 0.05), ("refresh",), ("remove", "A"), ("remove", "B"), ("close",), ("some_frames",)),
    *(("simulation.start", 0.01), ("simulation.stop",)),
)


async def act(host, rng):
    name, *given = rng.choice(ACTS)
    done = some_frames(host, rng) if name == "some_frames" else attrgetter(name)(host)(*given)
    if done is not None:
        await done


async def live_through(seed, model):
    """Let a host run unruly controllers; return the failures that were not reported to the main thread."""
    rng, let, made, told = random.Random(seed), threading.Event(), [], []
    own = {"rng": rng, "let": let, "made": made}
    one, other, third = (type("Unruly", (Unruly,), own) for _ in range(3))
    items = (BodyItem(Placement("A", model), (one, other)), BodyItem(Placement("B", model), (third,)))
    host, began = None, time.monotonic()
    try:
        host = Host(Project(model, items, 0.001), view=watched_view())
        for _ in range(8):
            try:
                await act(host, rng)
            except TutorialError as error:
                told.append(str(error))
            await asyncio.sleep(0)
    except TutorialError as error:  # a controller could not join its body
        told.append(str(error))
    finally:
        if host is not None:
            host.close()
            # A controller that hangs in called_back blocks only the executor.
            hanging = [each for each in made if each.hangs and each.method != "called_back"]
            assert host.simulation.state is State.ABANDONED or not hanging
            assert host.controllers == {}
        assert time.monotonic() - began < 50, "close must not wait for a controller that hangs for 60 s"
        let.set()
    return [text for each in made for text in each.raised if text not in "".join(told)]


@pytest.mark.parametrize("tens", range(20))
def test_a_host_shuts_down_and_reports_every_failure(tens, domain, tmp_path, monkeypatch, caplog):
    for name in ("simulation.STUCK", "program.run.HUNG", "ros.node_thread.SpinThread.timeout"):
        monkeypatch.setattr(f"tutorial.{name}", 0.05)
    model = tmp_path / "box.xml"  # the smallest usable model, which loads quickly
    model.write_text("<mujoco><worldbody><body><freejoint/><geom size='0.1'/></body></worldbody></mujoco>")
    before = threads()
    for seed in range(10 * tens, 10 * tens + 10):
        caplog.clear()
        untold = asyncio.run(live_through(seed, model))
        for thread in threads() - before:
            thread.join(TIMEOUT)
            assert not thread.is_alive(), f"seed {seed}: {thread}"
        assert [text for text in untold if text not in caplog.text] == [], f"seed {seed}"
